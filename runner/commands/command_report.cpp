// jnd report: a study as a page for people.
#include <array>
#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "data/blocks/result_blocks.h"
#include "data/fields/number_text.h"
#include "data/methods/methods_text.h"
#include "data/raw_trials/press_traces.h"
#include "data/results/study_results.h"
#include "data/study/blinding.h"
#include "protocols/version.h"
#include "runner/commands/commands.h"
#include "runner/opening/participant_names.h"
#include "runner/opening/study_access.h"
#include "runner/report/blinded_files.h"
#include "runner/report/report_files.h"
#include "runner/report/report_page.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/other_programs.h"
#include "runner/terminal/standard_streams.h"
#include "runner/terminal/terminal.h"
#include "runner/terminal/work_line.h"

namespace jnd {

namespace {

struct ReportOptions {
  std::string study;
  std::string file;                  // the page; empty: the study's name without extension + "-report.html", beside it
  std::string figures_folder;        // empty: the page's name without extension + "-figures", beside it
  std::optional<std::string> kind;   // real, pilot or simulated
  std::optional<std::string> by;     // nominal or delivered; without it, what the protocol registers
  std::vector<std::string> presses;  // trials whose force is shown: "P01:12"
  bool replace = false;              // an earlier report
  bool open = false;                 // in the browser
};

ReportFacts facts_of(const Study& study, const Protocol& protocol, const std::filesystem::path& path,
                     SessionKind kind) {
  ReportFacts facts;
  facts.program_version = kVersion;
  facts.study_file = path.filename().string();
  if (!plan_sealed(study, protocol)) facts.study_seed = study.info().seed;
  for (const SessionKind other : kinds_in(study))
    if (other != kind) facts.other_kinds.emplace_back(to_string(other));
  return facts;
}

// "P01:12": the trial of that number of that participant.
PressedTrial chosen_press(const Study& study, const Protocol& protocol, const std::vector<SessionInfo>& sessions,
                          const std::string& text) {
  const std::size_t colon = text.rfind(':');
  int number = 0;
  const char* const end = text.data() + text.size();
  const bool fine = colon != std::string::npos && [&] {
    const auto [behind, error] = std::from_chars(text.data() + colon + 1, end, number);
    return error == std::errc() && behind == end;
  }();
  if (!fine)
    throw UsageError(
        fmt::format("--press {}: a participant and the number of a trial are needed, such as P01:12", printable(text)));
  const std::string participant = participant_meant(text.substr(0, colon), sessions);
  if (std::optional<PressedTrial> trial = pressed_trial(study, protocol, sessions, participant, number))
    return std::move(*trial);
  throw UsageError(
      fmt::format("--press {}: no force was kept of trial {} of {} (--record full keeps it; trials.csv of jnd "
                  "export has the numbers)",
                  printable(text), number, printable(participant)));
}

ShownPresses presses_of(const Study& study, const Protocol& protocol, const std::vector<SessionInfo>& sessions,
                        const ReportOptions& options) {
  if (options.presses.empty()) return {.trials = pressed_trials(study, protocol, sessions)};
  if (options.presses.size() > kMostPresses)
    throw UsageError(fmt::format("--press: {} trials at most fit into the figure", kMostPresses));
  ShownPresses shown{.trials = {}, .chosen = true};
  for (const std::string& text : options.presses) shown.trials.push_back(chosen_press(study, protocol, sessions, text));
  return shown;
}

// Through $BROWSER where that is set, else xdg-open; does not wait for it. False where it cannot be started.
bool open_page(const std::filesystem::path& page) {
  const char* const browser = std::getenv("BROWSER");
  std::string program = browser == nullptr || *browser == '\0' ? "xdg-open" : browser;
  std::string file = std::filesystem::absolute(page).string();
  const std::array<char*, 3> arguments = {program.data(), file.data(), nullptr};
  const QuietSpawn quiet;
  pid_t child = 0;
  return posix_spawnp(&child, program.c_str(), &quiet.files, &quiet.attributes, arguments.data(), environ) == 0;
}

void show_page(const std::filesystem::path& page, const ReportOptions& options) {
  if (options.open && !open_page(page))
    write_marked_message(
        fmt::format("{}: no browser could be started ($BROWSER, xdg-open); open it yourself", page.string()));
}

int report_blinded(const Study& study, const Protocol& protocol, SessionKind kind, const ReportOptions& options,
                   ReportFiles files) {
  const BlindedResults results =
      blinded_results(study, protocol, kind, source_to_analyse(protocol, options.by), options.study);
  files.page_bytes = blinded_page(results, protocol, std::filesystem::path(options.study).filename().string());
  write_report(files, options.replace);
  fmt::print("{}: {} {} participant{}; one page that needs nothing else\n", bold(printable(files.page.string())),
             results.participants.size(), to_string(kind), results.participants.size() == 1 ? "" : "s");
  fmt::print("{}\n", warn(printable(results.line)));
  say_other_kinds(study, kind);
  show_page(files.page, options);
  return exit_code::kDone;
}

// Writes the page, and every figure as an SVG file of its own. A study without sessions of that kind has a page too,
// which says so.
int command_report(const ReportOptions& options) {
  const std::filesystem::path study_path = options.study;
  ReportFiles files;
  files.page = options.file.empty() ? study_path.parent_path() / (study_path.stem().string() + "-report.html")
                                    : std::filesystem::path(options.file);
  files.folder = options.figures_folder.empty() ? files.page.parent_path() / (files.page.stem().string() + "-figures")
                                                : std::filesystem::path(options.figures_folder);
  const std::unique_ptr<Study> study = Study::open(options.study, Study::Access::read_only);
  check_report_place(files.page, files.folder, options.replace);  // before the work, not after it
  const Protocol protocol = protocol_of(*study);
  const SessionKind kind = kind_to_analyse(*study, options.kind);
  const bool sealed = plan_sealed(*study, protocol);
  if (sealed && !options.presses.empty())
    throw UsageError("--press shows forces, and so the stimuli, and the study is blinded: leave it out");
  if (blinding_of(*study, protocol, kind).blinded)
    return report_blinded(*study, protocol, kind, options, std::move(files));
  std::optional<WorkLine> working(std::in_place, "analysing " + options.study);
  const StudyResults results =
      results_of(*study, protocol, kind, {.by = source_to_analyse(protocol, options.by), .hierarchical = true});
  const ShownPresses presses =
      sealed ? ShownPresses() : presses_of(*study, protocol, sessions_of(*study, kind), options);
  const std::vector<Figure> figures = study_figures(results, protocol, presses);
  files.page_bytes = report_page(results, protocol, result_blocks(results, protocol), figures,
                                 methods_text(*study, protocol, results), facts_of(*study, protocol, study_path, kind));
  for (const Figure& figure : figures) files.figures.emplace_back(figure.id + ".svg", figure.svg.file());
  write_report(files, options.replace);
  working.reset();
  fmt::print("{}: {} {} participant{}; one page that needs nothing else\n", bold(printable(files.page.string())),
             results.attendance.participants, to_string(kind), results.attendance.participants == 1 ? "" : "s");
  if (!figures.empty())
    fmt::print("{}: its {}, each an SVG file\n", printable(files.folder.string()),
               counted(static_cast<std::int64_t>(figures.size()), "figure"));
  for (const std::string& text : results.deviations) fmt::print("{}\n", warn("deviation: " + printable(text)));
  for (const std::string& text : results.cautions) fmt::print("{}\n", warn("caution: " + printable(text)));
  say_other_kinds(*study, kind);
  show_page(files.page, options);
  return exit_code::kDone;
}

}  // namespace

void add_report(CommandTree& tree) {
  const auto [command, options] = tree.add("report", "Write a page for people: figures, tables, cautions, methods",
                                           "jnd report s.sqlite", command_report);
  command.add_option("STUDY", options.study, "the study's file").required();
  command.add_option("--to", options.file, "the page (default: the study's name with -report.html, beside it)");
  command.add_option("--figures", options.figures_folder,
                     "the folder for the figures as SVG files (default: the page's name with -figures)");
  command.add_option("--press", options.presses,
                     "a trial whose force against depth is shown, such as P01:12; again for more (default: one of each "
                     "condition)");
  add_kind_and_by(command, options.kind, options.by);
  command.add_flag("--replace", options.replace, "replace an earlier report");
  command.add_flag("--open", options.open, "then open the page in the browser ($BROWSER, else xdg-open)");
}

}  // namespace jnd
