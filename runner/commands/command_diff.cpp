// jnd diff: what differs between two protocols, and whether it matters to who takes part.
#include <algorithm>
#include <array>
#include <optional>

#include <fmt/format.h>

#include "data/fields/number_text.h"
#include "protocols/input/json_text.h"
#include "protocols/input/read_file.h"
#include "protocols/input/resources.h"
#include "protocols/planning/allotment.h"
#include "protocols/planning/plan.h"
#include "protocols/reading/protocol_difference.h"
#include "protocols/reading/protocol_json.h"
#include "runner/commands/commands.h"
#include "runner/opening/protocol_fitness.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/json_output.h"
#include "runner/terminal/terminal.h"

namespace jnd {

namespace {

struct DiffOptions {
  std::string before, after;  // names or files of protocols
  bool json = false;
};

// Participants and seeds whose plans are compared: a change that spares all of them would be a curious one.
constexpr int kParticipants = 24;
constexpr std::uint64_t kSeeds = 3;
constexpr std::size_t kMostLines = 1000;

enum class Plans { same, different, unknown };

std::vector<std::string> names_of(const std::vector<Condition>& conditions) {
  std::vector<std::string> names;
  for (const Condition& condition : conditions) names.push_back(condition.name);
  return names;
}

// What a participant is presented, in which order.
bool same_plan(const Plan& a, const Plan& b) {
  return a.trials == b.trials && a.explorations == b.explorations && a.series_order == b.series_order &&
         a.condition_orders == b.condition_orders && a.conditions == b.conditions && a.group == b.group;
}

bool same_plans(const Protocol& a, const Protocol& b) {
  // Plans name conditions and groups by their places.
  if (names_of(a.conditions) != names_of(b.conditions) || group_names(a) != group_names(b) ||
      a.task.kind != b.task.kind || a.design.sessions != b.design.sessions)
    return false;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed)
    for (int participant = 1; participant <= kParticipants; ++participant)
      for (int session = 1; session <= a.design.sessions; ++session)
        if (!same_plan(make_plan(a, participant, seed, session), make_plan(b, participant, seed, session)))
          return false;
  return true;
}

// A plan names conditions and levels by their places: what is presented there follows from these sections.
bool changes_what_is_presented(const ProtocolChange& change) {
  constexpr std::array<std::string_view, 4> kSections = {"$.conditions", "$.rig", "$.stimulus", "$.design.procedure"};
  return !change.path.ends_with(".label") &&
         std::any_of(kSections.begin(), kSections.end(),
                     [&change](std::string_view section) { return change.path.starts_with(section); });
}

Plans compare_plans(const std::filesystem::path& before, const std::filesystem::path& after,
                    const std::vector<ProtocolChange>& changes) {
  const ProtocolCheck a = check_fitness(before), b = check_fitness(after);
  if (!a.errors.empty() || !b.errors.empty()) return Plans::unknown;
  if (std::any_of(changes.begin(), changes.end(), changes_what_is_presented)) return Plans::different;
  return same_plans(*a.protocol, *b.protocol) ? Plans::same : Plans::different;
}

const char* plans_text(Plans plans) {
  switch (plans) {
    case Plans::same:
      return "the plans are the same: each of the first 24 participants gets the same trials in the same order (three "
             "seeds compared)";
    case Plans::different:
      return "the plans differ: participants get other trials, or another order";
    case Plans::unknown:
      break;
  }
  return "the plans cannot be compared: one of the two has mistakes (jnd check)";
}

nlohmann::ordered_json value_json(const std::string& text) {
  return text.empty() ? nlohmann::ordered_json(nullptr) : json_from(text);
}

void print_difference_json(const DiffOptions& options, const ProtocolDifference& difference, Plans plans) {
  nlohmann::ordered_json changes = nlohmann::ordered_json::array();
  for (const ProtocolChange& change : difference.changes) {
    nlohmann::ordered_json one = {{"path", change.path},
                                  {"change", change.before.empty()  ? "added"
                                             : change.after.empty() ? "removed"
                                                                    : "changed"}};
    if (!change.before.empty()) one["before"] = value_json(change.before);
    if (!change.after.empty()) one["after"] = value_json(change.after);
    changes.push_back(std::move(one));
  }
  print_json({{"before", options.before},
              {"after", options.after},
              {"same_meaning", difference.same_meaning},
              {"same_plans", plans == Plans::unknown ? nlohmann::ordered_json(nullptr)
                                                     : nlohmann::ordered_json(plans == Plans::same)},
              {"changes", std::move(changes)}});
}

// Nothing that is presented, asked or analysed follows from these sections.
bool only_explains(const ProtocolChange& change) {
  constexpr std::array<std::string_view, 4> kSections = {"$.title", "$.notes", "$.assumed", "$.source"};
  return std::any_of(kSections.begin(), kSections.end(),
                     [&change](std::string_view section) { return change.path.starts_with(section); });
}

void print_difference(const DiffOptions& options, const ProtocolDifference& difference, Plans plans) {
  if (difference.same_meaning) {
    fmt::print("{} and {} mean the same: a study that was made with one goes on with the other\n",
               printable(options.before), printable(options.after));
    return;
  }
  const std::size_t shown = std::min(kMostLines, difference.changes.size());
  for (std::size_t i = 0; i < shown; ++i)
    if (!only_explains(difference.changes[i])) fmt::print("{}\n", printable(difference.lines[i]));
  bool first = true;
  for (std::size_t i = 0; i < shown; ++i) {
    if (!only_explains(difference.changes[i])) continue;
    fmt::print("{}  {}\n", first ? "In what explains the protocol to its readers:\n" : "",
               printable(difference.lines[i]));
    first = false;
  }
  if (shown < difference.changes.size()) fmt::print("{}\n", difference.lines.back());
  fmt::print("{}; {}\n", bold(counted(static_cast<std::int64_t>(difference.changes.size()), "difference")),
             plans_text(plans));
}

int command_diff(const DiffOptions& options) {
  const std::filesystem::path before = find_resource(Resource::protocol, options.before);
  const std::filesystem::path after = find_resource(Resource::protocol, options.after);
  const ProtocolDifference difference = difference_of(read_input_file(before), read_input_file(after), kMostLines);
  const Plans plans = difference.same_meaning ? Plans::same : compare_plans(before, after, difference.changes);
  if (options.json)
    print_difference_json(options, difference, plans);
  else
    print_difference(options, difference, plans);
  return difference.same_meaning ? exit_code::kDone : exit_code::kProblemFound;
}

}  // namespace

void add_diff(CommandTree& tree) {
  const auto [command, options] = tree.add("diff", "Say what differs between two protocols, and whether the plans do",
                                           "jnd diff chinello2017 chinello2017-balanced", command_diff);
  command.add_option("OLD", options.before, "protocol file, or name of a shipped one").required();
  command.add_option("NEW", options.after, "the other one; the exit code is 1 where they do not mean the same")
      .required();
  command.add_flag("--json", options.json, "machine-readable");
}

}  // namespace jnd
