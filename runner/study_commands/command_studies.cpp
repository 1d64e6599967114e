// jnd studies: every study in a folder, a line each.
#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "data/log/storage_error.h"
#include "protocols/input/input_error.h"
#include "runner/study_commands/study_commands.h"
#include "runner/study_commands/study_overview.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/json_output.h"
#include "runner/terminal/terminal.h"
#include "runner/terminal/text_table.h"
#include "runner/terminal/work_line.h"

namespace jnd {

namespace {

namespace fs = std::filesystem;

struct StudiesOptions {
  std::string folder = ".";
  bool json = false;
};

struct FoundStudy {
  std::string file;
  std::optional<StudyOverview> overview;  // none where it cannot be read
  std::string damage;                     // then why
};

FoundStudy look_into(const fs::path& file) {
  FoundStudy found;
  found.file = file.filename().string();
  try {
    found.overview = overview_of(*Study::open(file, Study::Access::read_only));
  } catch (const StorageError& error) {
    found.damage = error.what();
  } catch (const InputError& error) {
    found.damage = error.what();
  }
  return found;
}

std::vector<FoundStudy> studies_in(const fs::path& folder) {
  std::error_code error;
  fs::directory_iterator files(folder, error);
  if (error) throw UsageError(fmt::format("{}: cannot be listed: {}", folder.string(), error.message()));
  std::vector<fs::path> paths;
  for (const fs::directory_entry& entry : files)
    if (claims_to_be_study(entry.path())) paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  std::vector<FoundStudy> found;
  found.reserve(paths.size());
  for (const fs::path& path : paths) found.push_back(look_into(path));
  return found;
}

nlohmann::ordered_json to_json(const FoundStudy& study) {
  if (!study.overview) return {{"file", study.file}, {"state", "damaged"}, {"damage", study.damage}};
  const StudyOverview& overview = *study.overview;
  const std::string last = overview.last_session();
  nlohmann::ordered_json open = nlohmann::ordered_json::array();
  for (const SessionInfo& session : overview.open()) open.push_back(session.participant);
  return {{"file", study.file},
          {"protocol", overview.protocol},
          {"title", overview.title},
          {"kind", to_string(overview.kind)},
          {"participants",
           {{"finished", overview.finished},
            {"planned", overview.planned},
            {"left_early", overview.left_early},
            {"excluded", overview.excluded}}},
          {"open", std::move(open)},
          {"last_session", last.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(last)},
          {"blinded", overview.blinded},
          {"state", state_text(overview)}};
}

void print_studies(const std::vector<FoundStudy>& studies, const std::string& folder) {
  if (studies.empty()) {
    fmt::print("no study in {}\n", printable(folder));
    return;
  }
  using Align = TextTable::Align;
  TextTable table({"study", "protocol", "kind", "finished", "last session", "state"},
                  {Align::left, Align::left, Align::left, Align::right, Align::left, Align::left});
  constexpr std::size_t kDate = 10;  // 2026-11-25
  for (const FoundStudy& study : studies) {
    if (!study.overview) {
      table.add({printable(study.file), "", "", "", "", "damaged"});
      continue;
    }
    const StudyOverview& overview = *study.overview;
    const std::string last = overview.last_session().substr(0, kDate);
    table.add({printable(study.file), printable(overview.protocol),
               overview.sessions.empty() ? "-" : std::string(to_string(overview.kind)),
               fmt::format("{} of {}", overview.finished, overview.planned), last.empty() ? "-" : last,
               state_text(overview)});
  }
  fmt::print("{}", table.text());
  for (const FoundStudy& study : studies)
    if (!study.overview) fmt::print("{}\n", warn(printable(study.damage)));
}

int command_studies(const StudiesOptions& options) {
  const std::vector<FoundStudy> studies = [&options] {
    const WorkLine working("looking into the studies in " + options.folder);
    return studies_in(options.folder);
  }();
  if (!options.json) {
    print_studies(studies, options.folder);
    return exit_code::kDone;
  }
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const FoundStudy& study : studies) list.push_back(to_json(study));
  print_json({{"folder", options.folder}, {"studies", std::move(list)}});
  return exit_code::kDone;
}

}  // namespace

void add_studies(CommandTree& tree) {
  const auto [command, options] = tree.add("studies", "List the studies in a folder: how far each one is",
                                           "jnd studies ~/studies", command_studies);
  command.add_option("FOLDER", options.folder, "where they are, whatever else is there (default: this folder)");
  command.add_flag("--json", options.json, "machine-readable");
}

}  // namespace jnd
