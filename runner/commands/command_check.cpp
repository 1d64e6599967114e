// jnd check: every mistake in a protocol, before anyone takes part.
#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "data/fields/number_text.h"
#include "data/results/study_comparisons.h"
#include "protocols/course/duration.h"
#include "protocols/input/resources.h"
#include "protocols/planning/adaptive_run.h"
#include "protocols/planning/allotment.h"
#include "protocols/planning/plan.h"
#include "protocols/planning/specimen_codes.h"
#include "protocols/reading/protocol_json.h"
#include "protocols/rigs/rig_description.h"
#include "protocols/tasks/level_source.h"
#include "protocols/tasks/task.h"
#include "runner/commands/commands.h"
#include "runner/opening/asked_rig.h"
#include "runner/opening/protocol_fitness.h"
#include "runner/precision/precision_json.h"
#include "runner/precision/precision_text.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/json_output.h"
#include "runner/terminal/terminal.h"
#include "runner/terminal/work_line.h"

namespace jnd {

namespace {

struct CheckOptions {
  std::vector<std::string> protocols;
  std::string rig;  // a rig file to hold them against; empty: none
  bool json = false;
};

// Few enough for an answer at once; `jnd plan --precision` draws more.
constexpr int kDraws = 10'000;
constexpr int kExperiments = 1'000;

struct CheckedFile {
  ProtocolCheck check;
  std::optional<PlannedPrecision> precision;  // of a protocol without errors that has one
  int trials = 0;
  double duration_s = 0;
  std::optional<ToldByCodes> told{}, told_advised{};  // of specimens; none where none can be alike in a trial
};

PlannedPrecision planned_precision(const Protocol& protocol) {
  PrecisionQuestion question = precision_question(protocol);
  question.draws = kDraws;
  question.experiments = kExperiments;
  PlannedPrecision planned{precision(question), {}};
  for (const Condition& condition : protocol.conditions)
    planned.sources.push_back(planned_jnd(protocol, condition.name).source);
  return planned;
}

CheckedFile check_file(const std::string& name_or_path) {
  CheckedFile result;
  result.check = check_fitness(find_resource(Resource::protocol, name_or_path));
  if (!result.check.errors.empty()) return result;
  const Protocol& protocol = *result.check.protocol;
  constexpr std::uint64_t kAnySeed = 1;
  result.trials = main_trial_count(make_plan(protocol, first_of(protocol, largest_plan(protocol), kAnySeed), kAnySeed));
  result.duration_s = expected_duration_s(protocol);
  if (protocol.rig.device == kSpecimenRig) {
    result.told = told_by_codes(protocol);
    result.told_advised = told_by_codes(protocol, kAdvisedCodes);
  }
  if (has_precision(protocol)) result.precision = planned_precision(protocol);
  return result;
}

// Says that it is at work where that takes more than a second.
CheckedFile check_with_word(const std::string& name) {
  const WorkLine working("checking " + name);
  return check_file(name);
}

// What the rig file has to name, where the fingers' poses come from outside this program.
void print_tracker(const Protocol& protocol) {
  const std::string& tracker = protocol.rig.tracker;
  if (!is_streamed(tracker)) return;
  const char* const is = tracker == "hid"
                             ? "a tracker over USB; where there are several, the rig file gives its serial number"
                         : tracker == "process" ? "a program that writes poses; the rig file names it"
                                                : "a file of poses; the rig file names it";
  fmt::print("  tracker: {}, {} (jnd run --rig FILE)\n", tracker, is);
}

// What the codes of specimens give away, whatever the operator knows of the values.
void print_told(const CheckedFile& result) {
  if (!result.told) return;
  const Protocol& protocol = *result.check.protocol;
  std::size_t fewest = protocol.rig.specimens.front().codes.size();
  for (const Specimen& specimen : protocol.rig.specimens) fewest = std::min(fewest, specimen.codes.size());
  fmt::print(
      "  specimens: who remembers which codes came together tells in {:.0f} % of trials whether two are alike (by chance "
      "{:.0f} %)",
      100 * result.told->told, 100 * result.told->chance);
  if (fewest < kAdvisedCodes)
    fmt::print("; with {} codes per value in {:.0f} %, which is advised", kAdvisedCodes,
               100 * result.told_advised->told);
  fmt::print("\n");
}

// Of one participant; of groups, of the one with the most.
std::size_t conditions_each(const Protocol& protocol) {
  return conditions_of(protocol, largest_plan(protocol)).size();
}

// Which conditions each group gets, and how they are compared.
void print_groups(const Protocol& protocol) {
  if (protocol.groups.empty()) return;
  fmt::print("  {} groups, {}; compared by: {}{}\n", protocol.groups.size(),
             protocol.allotment == Allotment::balanced ? "allotted in balanced blocks" : "as the operator says",
             to_string(protocol.analysis.tests.between),
             everyone_has_all(protocol) ? "" : "; trials are those of the group with the most");
  for (const Group& group : protocol.groups) {
    std::string names;
    for (const int condition : group.conditions)
      names += (names.empty() ? "" : ", ") + condition_name(protocol, condition);
    fmt::print("    {} ({}): {}\n", group.name, printable(group.label), names);
  }
}

nlohmann::ordered_json groups_json(const Protocol& protocol) {
  nlohmann::ordered_json out = nlohmann::ordered_json::array();
  for (const Group& group : protocol.groups) {
    out.push_back({{"name", group.name}, {"conditions", nlohmann::ordered_json::array()}});
    for (const int condition : group.conditions)
      out.back()["conditions"].push_back(condition_name(protocol, condition));
  }
  return out;
}

void print_check(const std::string& name, const CheckedFile& result) {
  for (const Diagnostic& error : result.check.errors) fmt::print("error: {}\n", printable(to_text(error)));
  for (const Diagnostic& warning : result.check.warnings)
    fmt::print("{}: {}\n", warn("warning"), printable(to_text(warning)));
  if (!result.check.errors.empty()) {
    fmt::print("{}: {} error{}, {} warning{}\n", printable(name), result.check.errors.size(),
               result.check.errors.size() == 1 ? "" : "s", result.check.warnings.size(),
               result.check.warnings.size() == 1 ? "" : "s");
    return;
  }
  const Protocol& protocol = *result.check.protocol;
  if (protocol.explore) {
    fmt::print(
        "{}: {}\n  {}\n  {} conditions x {:g} s with {} object{}, {} question{}, about {} per session\n  SHA-256 {}\n",
        printable(name), bold("ok"), printable(protocol.title), protocol.conditions.size(),
        protocol.explore->duration_s, protocol.explore->objects.size(),
        protocol.explore->objects.size() == 1 ? "" : "s", protocol.questions.size(),
        protocol.questions.size() == 1 ? "" : "s", duration_text(result.duration_s), protocol.sha256);
    print_groups(protocol);
    print_tracker(protocol);
    return;
  }
  const std::string_view at_most = can_end_early(protocol) ? "at most " : "";
  fmt::print("{}: {}\n  {}\n  {} x {} = {}{} trials per participant{}, {}about {} per session\n  SHA-256 {}\n",
             printable(name), bold("ok"), printable(protocol.title),
             counted_words(conditions_each(protocol), "condition"), cells_text(protocol), at_most, result.trials,
             catch_words(protocol), at_most, duration_text(result.duration_s), protocol.sha256);
  print_groups(protocol);
  print_tracker(protocol);
  print_told(result);
  if (result.precision) fmt::print("\n{}", precision_summary(*result.precision, protocol, name));
}

void print_check_json(const CheckedFile& result) {
  nlohmann::ordered_json out;
  const bool ok = result.check.errors.empty();
  out["ok"] = ok;
  out["errors"] = nlohmann::ordered_json::array();
  for (const Diagnostic& error : result.check.errors) out["errors"].push_back(to_json(error));
  out["warnings"] = nlohmann::ordered_json::array();
  for (const Diagnostic& warning : result.check.warnings) out["warnings"].push_back(to_json(warning));
  out["trials"] = ok ? nlohmann::ordered_json(result.trials) : nlohmann::ordered_json(nullptr);
  out["duration_s"] = ok ? nlohmann::ordered_json(result.duration_s) : nlohmann::ordered_json(nullptr);
  out["precision"] =
      result.precision ? precision_json(*result.precision, *result.check.protocol) : nlohmann::ordered_json(nullptr);
  if (ok && !levels_given(*result.check.protocol)) out["trials_at_most"] = can_end_early(*result.check.protocol);
  if (ok && !result.check.protocol->groups.empty()) {
    out["groups"] = groups_json(*result.check.protocol);
    out["between"] = to_string(result.check.protocol->analysis.tests.between);
  }
  if (result.told)
    out["specimens"] = {{"told", result.told->told},
                        {"chance", result.told->chance},
                        {"told_with_six_codes", result.told_advised->told}};
  if (ok) out["tracker"] = result.check.protocol->rig.tracker;
  if (ok) out["sha256"] = result.check.protocol->sha256;
  fmt::print("{}\n", json_line(out));
}

int command_check(const CheckOptions& options) {
  bool all_ok = true;
  for (const std::string& name : options.protocols) {
    CheckedFile result = check_with_word(name);
    if (!options.rig.empty() && result.check.errors.empty()) {
      AskedRig asked = ask_rig_of(options.rig, *result.check.protocol);
      for (std::string& problem : asked.problems)
        result.check.errors.push_back({name, 0, 0, "$.rig", std::move(problem), ""});
      for (std::string& caution : asked.cautions)
        result.check.warnings.push_back({name, 0, 0, "$.rig", std::move(caution), ""});
    }
    all_ok = all_ok && result.check.errors.empty();
    if (options.json)
      print_check_json(result);
    else
      print_check(name, result);
  }
  return all_ok ? exit_code::kDone : exit_code::kInvalidInput;
}

}  // namespace

bool report_check(const std::string& protocol) {
  const CheckedFile result = check_with_word(protocol);
  print_check(protocol, result);
  return result.check.errors.empty();
}

void add_check(CommandTree& tree) {
  const auto [command, options] =
      tree.add("check", "Find every mistake in a protocol", "jnd check my-study.json", command_check);
  command.add_option("PROTOCOL", options.protocols, "protocol files or names of shipped ones").required();
  command.add_option("--rig", options.rig,
                     "also start the external rig of this rig file, and look whether it can present what they ask");
  command.add_flag("--json", options.json, "one JSON object a file");
}

}  // namespace jnd
