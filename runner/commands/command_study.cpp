// jnd status, verify and export: what a study holds.
#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "data/export/export.h"
#include "data/fields/number_text.h"
#include "data/results/study_results.h"
#include "data/study/blinding.h"
#include "data/verify/verify.h"
#include "data/verify/verify_deep.h"
#include "devices/loop/governor.h"
#include "runner/commands/commands.h"
#include "runner/keys/interrupt.h"
#include "runner/opening/study_access.h"
#include "runner/report/blinded_files.h"
#include "runner/study_commands/blinded_problem.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/json_output.h"
#include "runner/terminal/terminal.h"
#include "runner/terminal/text_table.h"
#include "runner/terminal/work_line.h"

namespace jnd {

namespace {

struct StatusOptions {
  std::string study;
  bool json = false;
};

struct VerifyOptions {
  std::string study;
  bool deep = false;
  bool json = false;
};

struct ExportOptions {
  std::string study;
  std::string folder;
  std::optional<std::string> kind;
  std::optional<std::string> by;
  bool replace = false;
  bool telemetry = false;  // the ticks of every interval too
};

int command_status(const StatusOptions& options) {
  std::optional<WorkLine> working(std::in_place, "reading " + options.study);
  const std::unique_ptr<Study> study = Study::open(options.study, Study::Access::read_only);
  const StudyInfo& info = study->info();
  const std::vector<SessionInfo> sessions = study->sessions();
  const Protocol protocol = protocol_of(*study);
  const BlindingState blinding = blinding_of(*study, protocol, SessionKind::real);
  const bool sealed = plan_sealed(*study, protocol);
  working.reset();
  // Who says a group knows it; one that was drawn stays sealed.
  const bool shows_groups = !protocol.groups.empty() && (!sealed || protocol.allotment == Allotment::given);
  if (options.json) {
    nlohmann::ordered_json out = {
        {"protocol", info.protocol_name},
        {"protocol_sha256", info.protocol_sha256},
        {"seed", sealed ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(info.seed)},
        {"blinding", to_json(blinding)},
        {"study_head", study->head()}};
    out["sessions"] = nlohmann::ordered_json::array();
    for (const SessionInfo& session : sessions) {
      out["sessions"].push_back(
          {{"id", session.id},
           {"participant", session.participant},
           {"kind", to_string(session.kind)},
           {"state", session.state},
           {"excluded", session.excluded},
           {"ended_early", session.ended_early},
           {"unblinded", session.unblinded},
           {"trials_done", session.trials_done},
           {"trials_total", session.trials_total},
           {"trials_voided", session.trials_voided},
           {"responder", session.responder},
           {"started", session.started},
           {"ended", session.ended.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(session.ended)},
           {"head", sealed && session.state != "closed" ? nlohmann::ordered_json(nullptr)
                                                        : nlohmann::ordered_json(session.head)}});
      if (shows_groups) out["sessions"].back()["group"] = session.group;
    }
    fmt::print("{}\n", json_line(out));
    return exit_code::kDone;
  }
  fmt::print("{}: protocol {} ({}...), seed {}\n", bold(printable(options.study)), printable(info.protocol_name),
             info.protocol_sha256.substr(0, 12), seed_text(*study, protocol, "sealed"));
  if (sealed) fmt::print("{}\n", warn(printable(blinding_line(blinding, shell_word(options.study)))));
  if (sessions.empty()) {
    fmt::print("  no session yet\n");
    return exit_code::kDone;
  }
  using Align = TextTable::Align;
  std::vector<std::string> heads = {"participant", "kind",    "state", "trials",
                                    "voided",      "started", "ended", "answers by"};
  std::vector<Align> aligned = {Align::left,  Align::left, Align::left, Align::right,
                                Align::right, Align::left, Align::left, Align::left};
  if (shows_groups) {
    heads.insert(heads.begin() + 1, "group");
    aligned.insert(aligned.begin() + 1, Align::left);
  }
  TextTable table(heads, aligned);
  for (const SessionInfo& session : sessions) {
    std::vector<std::string> row = {printable(session.participant),
                                    std::string(to_string(session.kind)),
                                    state_text(session),
                                    fmt::format("{} of {}", session.trials_done, session.trials_total),
                                    std::to_string(session.trials_voided),
                                    session.started.substr(0, 19),
                                    session.ended.substr(0, std::min<std::size_t>(19, session.ended.size())),
                                    printable(session.responder)};
    if (shows_groups) row.insert(row.begin() + 1, printable(session.group));
    table.add(row);
  }
  fmt::print("{}  {}\n", table.text(), dim("head of the study's own chain: " + study->head()));
  return exit_code::kDone;
}

int command_verify(const VerifyOptions& options) {
  std::optional<WorkLine> working(std::in_place, "verifying " + options.study);
  const std::unique_ptr<Study> study = Study::open(options.study, Study::Access::read_only);
  VerifyReport report = verify(*study);
  DeepReport deep;
  if (options.deep) deep = verify_deep(*study);
  working.reset();
  report.problems.insert(report.problems.end(), deep.problems.begin(), deep.problems.end());
  const std::vector<std::string> problems = unsealed_problems(report.problems, *study);
  const bool ok = problems.empty();
  if (options.json) {
    nlohmann::ordered_json out = {{"ok", ok},
                                  {"sessions", report.sessions},
                                  {"events", report.events},
                                  {"trials", report.trials},
                                  {"voided", report.voided},
                                  {"telemetry", report.telemetry},
                                  {"telemetry_lost", report.telemetry_lost},
                                  {"study_head", report.study_head},
                                  {"problems", problems}};
    if (options.deep)
      out["deep"] = {{"sessions", deep.sessions},
                     {"intervals", deep.intervals},
                     {"numbers", deep.numbers},
                     {"bytes", deep.bytes},
                     {"findings", deep.findings}};
    fmt::print("{}\n", json_line(out));
  } else {
    for (const std::string& problem : problems) fmt::print("problem: {}\n", printable(problem));
    fmt::print("{}: {} ({} session{}, {} events, {} trials, {} voided{})\n", printable(options.study),
               ok ? bold("every hash and every planned stimulus agrees")
                  : fmt::format("{} problem{}", problems.size(), problems.size() == 1 ? "" : "s"),
               report.sessions, report.sessions == 1 ? "" : "s", report.events, report.trials, report.voided,
               report.telemetry > 0 ? fmt::format(", telemetry of {} intervals", report.telemetry) : std::string());
    if (report.telemetry_lost > 0)
      fmt::print("{}\n", warn(fmt::format("  ticks of {} interval{} are said to be lost (study.recovered)",
                                          report.telemetry_lost, report.telemetry_lost == 1 ? "" : "s")));
    if (!report.study_head.empty())
      fmt::print("  {}\n", dim("head of the study's own chain: " + printable(report.study_head)));
    if (options.deep)
      fmt::print("  the course of {} was followed, {} of {} computed again, {} bytes read\n",
                 counted(deep.sessions, "session"), counted(deep.numbers, "number"),
                 counted(deep.intervals, "interval"), deep.bytes);
    for (const std::string& finding : deep.findings) fmt::print("  {}\n", printable(finding));
  }
  return ok ? exit_code::kDone : exit_code::kProblemFound;
}

// What people open first, as far as it is there.
std::string main_files(const std::vector<std::string>& files) {
  constexpr std::array kMain = {"trials.csv",    "intervals.csv", "tracks.csv",
                                "estimates.csv", "group.csv",     "contrasts.csv"};
  std::string text;
  for (const char* name : kMain)
    if (std::find(files.begin(), files.end(), name) != files.end()) text += fmt::format("{}, ", name);
  return text + "...";
}

bool is_within(const std::vector<std::string>& files, std::string_view part) {
  return std::any_of(files.begin(), files.end(),
                     [&](const std::string& file) { return file.find(part) != std::string::npos; });
}

// Where the files are and what to do with them. holds: "simulated data". In lines that fit a narrow terminal.
void say_exported(const std::string& folder, const std::vector<std::string>& files, const std::string& holds) {
  fmt::print("{}: {} of {}\n  {}\n  dictionary.csv and datapackage.json say what every column is\n",
             bold(printable(folder)), counted(static_cast<std::int64_t>(files.size()), "file"), holds,
             main_files(files));
  if (!is_within(files, "recompute.")) return;
  fmt::print(
      "  to compute the results again, in that folder:\n    R:       source(\"recompute.R\")\n"
      "    Python:  python3 recompute.py\n");
}

int export_in_code(const Study& study, const Protocol& protocol, SessionKind kind, const ExportOptions& options) {
  const BlindedResults results =
      blinded_results(study, protocol, kind, source_to_analyse(protocol, options.by), options.study);
  const HoldInterrupts hold;
  const std::vector<std::string> files = export_blinded(study, protocol, results, options.folder, options.replace);
  fmt::print("{}\n", warn(printable(results.line)));
  say_exported(options.folder, files, coded_data(kind));
  say_other_kinds(study, kind);
  return exit_code::kDone;
}

int command_export(const ExportOptions& options) {
  const std::unique_ptr<Study> study = Study::open(options.study, Study::Access::read_only);
  const Protocol protocol = protocol_of(*study);
  const SessionKind kind = kind_to_analyse(*study, options.kind);
  if (options.telemetry && plan_sealed(*study, protocol))
    throw UsageError(blinding_line(blinding_of(*study, protocol, SessionKind::real), shell_word(options.study)) +
                     "\nThe recorded forces give the stimuli away: export without --telemetry until then");
  if (blinding_of(*study, protocol, kind).blinded) return export_in_code(*study, protocol, kind, options);
  std::optional<WorkLine> working(std::in_place, "exporting " + options.study);
  const StudyResults results =
      results_of(*study, protocol, kind, {.by = source_to_analyse(protocol, options.by), .hierarchical = true});
  std::optional<TelemetryExport> telemetry;
  if (options.telemetry) telemetry = {{limit::kNames.begin(), limit::kNames.end()}};
  const HoldInterrupts hold;
  const std::vector<std::string> files =
      export_csv(*study, protocol, results, options.folder, options.replace, telemetry);
  working.reset();
  say_exported(options.folder, files, fmt::format("{} data", to_string(kind)));
  if (plan_sealed(*study, protocol))
    fmt::print("{}\n",
               warn("Real sessions of this study are blinded, and every kind has their plan: the files of single "
                    "trials and answers and the seed are left out."));
  if (options.telemetry && !is_within(files, "/telemetry/"))
    fmt::print("this study holds no telemetry of {} sessions\n", to_string(kind));
  say_other_kinds(*study, kind);
  return exit_code::kDone;
}

}  // namespace

void add_status(CommandTree& tree) {
  const auto [command, options] = tree.add("status", "What a study holds", "jnd status s.sqlite", command_status);
  command.add_option("STUDY", options.study, "the study's file").required();
  command.add_flag("--json", options.json, "machine-readable");
}

void add_verify(CommandTree& tree) {
  const auto [command, options] =
      tree.add("verify", "Recompute every hash and every planned stimulus", "jnd verify s.sqlite", command_verify);
  command.add_option("STUDY", options.study, "the study's file").required();
  command.add_flag("--deep", options.deep,
                   "also every number that telemetry gives, the course of every session, and the file itself");
  command.add_flag("--json", options.json, "machine-readable");
}

void add_kind_and_by(const Command& command, std::optional<std::string>& kind, std::optional<std::string>& by) {
  command.add_option("--kind", kind, "real, pilot or simulated (default: the only one, or real)");
  command
      .add_option("--by", by,
                  "slopes over nominal or delivered stiffness differences (default: what the protocol registers)")
      .one_of({"nominal", "delivered"});
}

void add_export(CommandTree& tree) {
  const auto [command, options] = tree.add("export", "Write the data and the results as CSV files for R and Python",
                                           "jnd export s.sqlite --to results", command_export);
  command.add_option("STUDY", options.study, "the study's file").required();
  command.add_option("--to", options.folder, "the folder to write").required();
  add_kind_and_by(command, options.kind, options.by);
  command.add_flag("--telemetry", options.telemetry, "also every tick of every interval, a file each");
  command.add_flag("--replace", options.replace, "replace the folder of an earlier export");
}

}  // namespace jnd
