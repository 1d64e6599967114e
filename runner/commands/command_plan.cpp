// jnd plan: every trial of a participant in order, the balance of a whole cohort, or what the design will measure.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "data/study/blinding.h"
#include "protocols/condition_words.h"
#include "protocols/planning/adaptive_run.h"
#include "protocols/planning/allotment.h"
#include "protocols/planning/cohort.h"
#include "protocols/planning/plan.h"
#include "protocols/protocol.h"
#include "protocols/tasks/task.h"
#include "runner/commands/commands.h"
#include "runner/commands/power_options.h"
#include "runner/commands/precision_options.h"
#include "runner/opening/participant_names.h"
#include "runner/opening/study_access.h"
#include "runner/results/blinded_results.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/json_output.h"
#include "runner/terminal/terminal.h"
#include "runner/terminal/text_table.h"

namespace jnd {

namespace {

const Condition& condition_of(const Protocol& protocol, const ExplorationSlot& slot) {
  return protocol.conditions[static_cast<std::size_t>(slot.condition)];
}

const std::string& object_of(const Protocol& protocol, const ExplorationSlot& slot) {
  return protocol.explore->objects[static_cast<std::size_t>(slot.object)];
}

// A table of conditions and objects in order.
void print_explorations(const Protocol& protocol, const Plan& plan) {
  using Align = TextTable::Align;
  TextTable table({"part", "block", "condition", "object", "s", ""},
                  {Align::right, Align::right, Align::left, Align::left, Align::right, Align::left});
  int block = 1;
  for (const ExplorationSlot& slot : plan.explorations) {
    if (slot.block != block) table.rule();
    block = slot.block;
    table.add({std::to_string(slot.index), std::to_string(slot.block), condition_of(protocol, slot).name,
               object_of(protocol, slot), fmt::format("{:g}", slot.duration_s),
               condition_of(protocol, slot).devices ? "with devices" : "without devices"});
  }
  fmt::print("{}", table.text());
}

// Rows of index, block, condition, devices, object and duration_s.
nlohmann::ordered_json explorations_json(const Protocol& protocol, const Plan& plan) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const ExplorationSlot& slot : plan.explorations)
    rows.push_back({{"index", slot.index},
                    {"block", slot.block},
                    {"condition", condition_of(protocol, slot).name},
                    {"devices", condition_of(protocol, slot).devices},
                    {"object", object_of(protocol, slot)},
                    {"duration_s", slot.duration_s}});
  return rows;
}

struct PlanOptions {
  std::string protocol;
  std::optional<std::string> study;  // its protocol and seed, instead of those here
  std::string participant = "1";     // a number of the plan, or a code
  int session = 1;                   // of that participant, or of all of them
  std::string group;                 // whose member the participant is, or whose balance is asked for
  std::optional<int> cohort;
  std::optional<std::uint64_t> seed;  // 1 where not given
  bool json = false;
  PrecisionOptions precision;
  PowerOptions power;
};

std::vector<std::string> names_in_order(const std::vector<int>& order, const auto& things) {
  std::vector<std::string> names;
  for (const int place : order) names.push_back(things[static_cast<std::size_t>(place)].name);
  return names;
}

constexpr std::string_view kSetLater = "set by answers";
constexpr std::array<std::string_view, kMostIntervals> kOrdinals = {"first", "second", "third"};

bool set_later(const Trial& trial, std::size_t interval) {
  return trial.track > 0 && trial.stimuli[interval] == set_by_answers(trial.standard);
}

std::string stimulus_text(const Trial& trial, std::size_t interval) {
  if (set_later(trial, interval)) return std::string(kSetLater);
  return fmt::format("{:g}", trial.stimuli[interval]);
}

nlohmann::ordered_json stimulus_json(const Trial& trial, std::size_t interval) {
  if (set_later(trial, interval)) return nullptr;
  return trial.stimuli[interval];
}

// ", group old"; empty where there are none.
std::string group_text(const Protocol& protocol, const Plan& plan) {
  return plan.group ? fmt::format(", group {}", group_name(protocol, plan.group)) : std::string();
}

// sessions: of the study whose plan it is; null where it is that of a protocol alone.
void print_plan(const Protocol& protocol, const Plan& plan, const std::vector<SessionInfo>* sessions) {
  fmt::print(
      "{}\n{}\n", bold(printable(protocol.title)),
      dim(fmt::format("{}{}{}, seed {}, protocol {}", participant_title(plan.participant, sessions),
                      group_text(protocol, plan), plan.session == 1 ? "" : fmt::format(", session {}", plan.session),
                      plan.seed, protocol.sha256.substr(0, 12))));
  if (!plan.explorations.empty()) return print_explorations(protocol, plan);
  fmt::print("series: {}\n", fmt::join(names_in_order(plan.series_order, protocol.series), ", "));
  for (std::size_t i = 0; i < plan.condition_orders.size(); ++i)
    fmt::print("conditions in series {}: {}\n", protocol.series[static_cast<std::size_t>(plan.series_order[i])].name,
               fmt::join(names_in_order(plan.condition_orders[i], protocol.conditions), ", "));
  fmt::print("\n");
  using Align = TextTable::Align;
  const std::string_view unit = to_string(protocol.stimulus.unit);
  const Task& task = task_of(protocol.task.kind);
  const auto intervals = static_cast<std::size_t>(task.intervals(protocol.task));
  std::vector<std::string> heads = {"trial", "block", "series", "condition"};
  std::vector<Align> aligned = {Align::right, Align::right, Align::left, Align::left};
  for (std::size_t i = 0; i < intervals; ++i) {
    heads.push_back(intervals == 1 ? std::string(unit) : fmt::format("{} {}", kOrdinals[i], unit));
    aligned.push_back(Align::right);
  }
  heads.insert(heads.end(), {"", ""});
  aligned.insert(aligned.end(), {Align::left, Align::left});
  TextTable table(heads, aligned);
  int block = plan.trials.empty() ? 0 : plan.trials.front().block;
  for (const Trial& trial : plan.trials) {
    if (trial.block != block) table.rule();
    block = trial.block;
    std::vector<std::string> row = {std::to_string(trial.index), trial.practice ? "-" : std::to_string(trial.block),
                                    protocol.series[static_cast<std::size_t>(trial.series)].name,
                                    protocol.conditions[static_cast<std::size_t>(trial.condition)].name};
    for (std::size_t i = 0; i < intervals; ++i) row.push_back(stimulus_text(trial, i));
    row.push_back(task.target_word(trial, protocol.task));
    row.push_back(trial.practice    ? fmt::format("practice round {}", trial.round)
                  : trial.track > 0 ? fmt::format("track {}{}", trial.track, is_catch(trial) ? ", catch" : "")
                                    : "");
    table.add(row);
  }
  fmt::print("{}", table.text());
  fmt::print("{}", early_end_note(protocol));
}

void print_plan_json(const Protocol& protocol, const Plan& plan) {
  nlohmann::ordered_json out = {
      {"participant", plan.participant}, {"protocol_sha256", protocol.sha256}, {"seed", plan.seed}};
  if (plan.group) out["group"] = group_name(protocol, plan.group);
  if (plan.session > 1) out["session"] = plan.session;
  if (!plan.explorations.empty()) out["explorations"] = explorations_json(protocol, plan);
  out["trials"] = nlohmann::ordered_json::array();
  for (const Trial& trial : plan.trials) {
    nlohmann::ordered_json row = {{"index", trial.index},
                                  {"block", trial.block},
                                  {"series", protocol.series[static_cast<std::size_t>(trial.series)].name},
                                  {"condition", protocol.conditions[static_cast<std::size_t>(trial.condition)].name},
                                  {"practice", trial.practice},
                                  {"stimuli", nlohmann::ordered_json::array()}};
    for (std::size_t i = 0; i < trial.stimuli.size(); ++i) row["stimuli"].push_back(stimulus_json(trial, i));
    const Task& task = task_of(trial.task);
    if (const std::string_view key = task.first_class_key(); !key.empty())
      row[std::string(key)] = trial.target == 0;
    else
      row["target"] = trial.target < 0 ? nlohmann::ordered_json(nullptr)
                                       : nlohmann::ordered_json(task.target_word(trial, protocol.task));
    if (trial.practice) row["round"] = trial.round;
    if (trial.track > 0) row["track"] = trial.track;
    out["trials"].push_back(row);
  }
  fmt::print("{}\n", json_line(out));
}

nlohmann::ordered_json to_json(const CohortBalance& balance, const Protocol& protocol) {
  nlohmann::ordered_json out = {{"participants", balance.participants},
                                {"seed", balance.seed},
                                {"protocol_sha256", protocol.sha256},
                                {"group_size", balance.group_size},
                                {"pair_count", balance.pair_count},
                                {"different_pairs_of_orders", balance.different_pairs_of_orders},
                                {"most_used_pair", balance.most_used_pair},
                                {"same", balance.same},
                                {"different", balance.different},
                                {"condition_positions", balance.condition_positions},
                                {"series_positions", balance.series_positions},
                                {"condition_transitions", balance.condition_transitions},
                                {"cells", nlohmann::ordered_json::array()}};
  if (balance.group) out["group"] = group_name(protocol, balance.group);
  if (balance.session > 1) out["session"] = balance.session;
  if (!balance.object_positions.empty()) out["object_positions"] = balance.object_positions;
  const bool pairs = task_of(protocol.task.kind).has_pairs();
  for (const CellBalance& cell : balance.cells) {
    nlohmann::ordered_json row = {{"series", protocol.series[static_cast<std::size_t>(cell.series)].name},
                                  {"condition", condition_name(protocol, cell.condition)}};
    if (pairs) {
      row.update({{"pairs", cell.pairs}, {"same", cell.same}, {"different", cell.different}});
      row.update({{"least_same", cell.least_same}, {"most_same", cell.most_same}});
    } else {
      row["arrangements"] = nlohmann::ordered_json::array();
      for (const auto& [stimuli, times] : cell.arrangements)
        row["arrangements"].push_back({{"stimuli", stimuli}, {"trials", times}});
      row["targets"] = cell.targets;
    }
    out["cells"].push_back(row);
  }
  return out;
}

std::string round_text(const Trial& trial) {
  return trial.practice ? fmt::format("practice round {}", trial.round) : "";
}

// The place of the group that is named; none where none is.
std::optional<int> group_asked(const Protocol& protocol, const PlanOptions& options) {
  if (options.group.empty()) return std::nullopt;
  if (protocol.groups.empty()) throw UsageError("--group: the protocol has no groups");
  const std::optional<int> group = group_named(protocol, options.group);
  if (!group)
    throw UsageError(fmt::format("--group {}: the protocol has the groups {}", printable(options.group),
                                 fmt::join(group_names(protocol), ", ")));
  return group;
}

// Of the participant that is asked for: a number or a code, or with a group that is given the number of a member.
int number_of(const Protocol& protocol, const PlanOptions& options, const std::vector<SessionInfo>& sessions) {
  const std::optional<int> group = group_asked(protocol, options);
  if (!group) return plan_number_meant(options.participant, sessions);
  if (protocol.allotment != Allotment::given)
    throw UsageError("--group: numbers are allotted to groups by the seed; leave it out, and the plan says the group");
  return number_of_member(protocol, *group, plan_number_meant(options.participant, {}));
}

// The groups one by one, each with its own balance; or the one that is named.
int print_cohort(const Protocol& protocol, std::uint64_t seed, const PlanOptions& options) {
  std::vector<std::optional<int>> groups = {group_asked(protocol, options)};
  if (!protocol.groups.empty() && !groups.front()) {
    groups.clear();
    for (int group = 0; group < group_count(protocol); ++group) groups.emplace_back(group);
  }
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const std::optional<int> group : groups) {
    const CohortBalance balance = balance_of_cohort(protocol, *options.cohort, seed, options.session, group);
    if (options.json)
      all.push_back(to_json(balance, protocol));
    else
      fmt::print("{}{}", group == groups.front() ? "" : "\n", to_text(balance, protocol));
  }
  if (options.json)
    fmt::print("{}\n", json_line(groups.size() == 1
                                     ? all.front()
                                     : nlohmann::ordered_json({{"participants", *options.cohort}, {"groups", all}})));
  return exit_code::kDone;
}

// What the operator's console may show: place, block and coded condition. Practice has no code: it takes the conditions
// in the protocol's own order, which would name the letters.
int plan_in_code(const Study& study, const Protocol& protocol, const PlanOptions& options) {
  const BlindingState state = blinding_of(study, protocol, SessionKind::real);
  const std::string line = blinding_line(state, shell_word(*options.study));
  if (options.cohort)
    throw UsageError(line + "\nThe balance of the cohort names conditions: leave --cohort out until then");
  const std::vector<SessionInfo> sessions = study.sessions();
  const Plan plan = make_plan(protocol, number_of(protocol, options, sessions), study.info().seed, options.session);
  // Who says a group knows it; one that was drawn stays sealed.
  const bool knows_group = protocol.allotment == Allotment::given;
  const std::vector<std::string> codes = condition_codes(protocol, study.info().seed);
  const auto code = [&](int condition) { return codes[static_cast<std::size_t>(condition)]; };
  if (options.json) {
    nlohmann::ordered_json out = {{"participant", plan.participant},
                                  {"protocol_sha256", protocol.sha256},
                                  {"seed", nullptr},
                                  {"blinding", to_json(state)}};
    if (plan.group && knows_group) out["group"] = group_name(protocol, plan.group);
    out["trials"] = nlohmann::ordered_json::array();
    for (const Trial& trial : plan.trials)
      out["trials"].push_back({{"index", trial.index},
                               {"block", trial.block},
                               {"condition_code", trial.practice ? nlohmann::ordered_json(nullptr)
                                                                 : nlohmann::ordered_json(code(trial.condition))},
                               {"practice", trial.practice}});
    if (!plan.explorations.empty()) out["explorations"] = nlohmann::ordered_json::array();
    for (const ExplorationSlot& slot : plan.explorations)
      out["explorations"].push_back(
          {{"index", slot.index}, {"block", slot.block}, {"condition_code", code(slot.condition)}});
    fmt::print("{}\n", json_line(out));
    return exit_code::kDone;
  }
  fmt::print("{}\n{}\n{}\n\n", bold(printable(protocol.title)),
             dim(fmt::format("{}{}, protocol {}", participant_title(plan.participant, &sessions),
                             knows_group ? group_text(protocol, plan) : "", protocol.sha256.substr(0, 12))),
             warn(printable(line)));
  using Align = TextTable::Align;
  TextTable table({"trial", "block", "condition", ""}, {Align::right, Align::right, Align::left, Align::left});
  for (const Trial& trial : plan.trials)
    table.add({std::to_string(trial.index), trial.practice ? "-" : std::to_string(trial.block),
               trial.practice ? "-" : code(trial.condition), round_text(trial)});
  for (const ExplorationSlot& slot : plan.explorations)
    table.add({std::to_string(slot.index), std::to_string(slot.block), code(slot.condition), "exploration"});
  fmt::print("{}", table.text());
  return exit_code::kDone;
}

int plan_of_protocol(const Protocol& protocol, std::uint64_t seed, const PlanOptions& options,
                     const std::vector<SessionInfo>* sessions = nullptr) {
  if (options.cohort) return print_cohort(protocol, seed, options);
  const int number = number_of(protocol, options, sessions == nullptr ? std::vector<SessionInfo>() : *sessions);
  const Plan plan = make_plan(protocol, number, seed, options.session);
  if (options.json)
    print_plan_json(protocol, plan);
  else
    print_plan(protocol, plan, sessions);
  return exit_code::kDone;
}

// What an order of trials does not depend on.
void refuse_figures(const PrecisionOptions& options) {
  const auto refuse = [](const char* name, bool given) {
    if (given) refuse_arguments(fmt::format("{} requires --precision or --power", name));
  };
  refuse("--jnd", !options.jnds.empty());
  refuse("--trials", !options.trials.empty());
  refuse("--participants", !options.participants.empty());
  refuse("--between-cv", options.between_cv.has_value());
}

int command_plan(const PlanOptions& options) {
  if (options.protocol.empty() && !options.precision.asked && !options.study) refuse_arguments("PROTOCOL is required");
  if (options.precision.asked && options.study) refuse_arguments("--precision excludes --study");
  if (options.power.asked && options.study) refuse_arguments("--power excludes --study");
  if (options.power.asked && options.precision.asked) refuse_arguments("--power excludes --precision");
  const std::uint64_t given_seed = options.seed.value_or(1);
  if (options.power.asked)
    return plan_power(options.protocol, given_seed, options.json, options.precision, options.power);
  if (!options.precision.asked) refuse_figures(options.precision);
  if (options.precision.asked)
    return plan_precision(options.protocol.empty() ? "chinello2017" : options.protocol, given_seed, options.json,
                          options.precision);
  if (!options.study) return plan_of_protocol(load_checked_protocol(options.protocol), given_seed, options);
  if (!options.protocol.empty() || options.seed)
    throw UsageError("a study has its own protocol and seed: leave PROTOCOL and --seed out, or --study");
  const std::unique_ptr<Study> study = Study::open(*options.study, Study::Access::read_only);
  const Protocol protocol = protocol_of(*study);
  if (plan_sealed(*study, protocol)) return plan_in_code(*study, protocol, options);
  const std::vector<SessionInfo> sessions = study->sessions();
  return plan_of_protocol(protocol, study->info().seed, options, &sessions);
}

}  // namespace

void add_plan(CommandTree& tree) {
  const auto [command, options] =
      tree.add("plan", "Print a participant's trials, a cohort's balance, or what a design will measure and find",
               "jnd plan chinello2017 --participant P07 --seed 1", command_plan);
  command.add_option("PROTOCOL", options.protocol,
                     "protocol file, or name of a shipped one (with --precision: chinello2017 where none is named)");
  command.add_option("--participant", options.participant,
                     "a number of the plan, such as 7, or a code: P07; of a study whoever has a session (default: 1)");
  command.add_option("--session", options.session, "which of the participant's sessions (default: 1)").range(1, 20);
  command.add_option("--group", options.group,
                     "where groups are given: --participant counts its members; with --cohort: its balance alone");
  command.add_option("--cohort", options.cohort, "show the balance over participants 1..N instead").range(1, 10'000);
  command.add_option("--seed", options.seed, "the study's seed (default: 1)");
  command.add_option("--study", options.study, "the plan of a study's participant, by its own protocol and seed");
  command.add_flag("--json", options.json, "machine-readable");
  add_precision_options(command, options.precision);
  add_power_options(command, options.power);
}

}  // namespace jnd
