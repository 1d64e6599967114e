#include "protocols/planning/cohort.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "protocols/input/json_reader.h"
#include "protocols/planning/allotment.h"
#include "protocols/planning/order.h"
#include "protocols/planning/plan.h"
#include "protocols/tasks/level_source.h"
#include "protocols/tasks/task.h"

namespace jnd {

namespace {

using Table = std::vector<std::vector<int>>;

Table square(std::size_t size) {
  return Table(size, std::vector<int>(size, 0));
}

int& at(Table& table, int row, int column) {
  return table[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
}

std::vector<OrderUse> by_use(const std::map<std::vector<int>, int>& uses) {
  std::vector<OrderUse> orders;
  for (const auto& [order, participants] : uses) orders.push_back({order, participants});
  std::stable_sort(orders.begin(), orders.end(),
                   [](const OrderUse& a, const OrderUse& b) { return a.participants > b.participants; });
  return orders;
}

std::size_t cell_of(const Trial& trial, const Protocol& protocol) {
  return static_cast<std::size_t>(trial.series) * protocol.conditions.size() +
         static_cast<std::size_t>(trial.condition);
}

bool gets(const Plan& plan, int condition) {
  return std::find(plan.conditions.begin(), plan.conditions.end(), condition) != plan.conditions.end();
}

void count_trials(const Plan& plan, const Protocol& protocol, CohortBalance& balance) {
  std::vector<int> first_class(balance.cells.size());  // of this participant
  for (const Trial& trial : plan.trials) {
    if (trial.practice) continue;
    const std::size_t place = cell_of(trial, protocol);
    CellBalance& cell = balance.cells[place];
    std::vector<double> arrangement(trial.stimuli.begin(), trial.stimuli.end());
    if (trial.track > 0) arrangement.push_back(trial.side);
    ++cell.arrangements[arrangement];
    cell.targets.resize(protocol.task.classes.size());
    if (trial.target >= 0) ++cell.targets[static_cast<std::size_t>(trial.target)];
    if (trial.target == 0) ++first_class[place];
    if (!task_of(trial.task).has_pairs()) continue;
    const bool same = trial.target == kClassSame;
    // Of an adaptive procedure a is the comparison, whatever its level.
    const double a = trial.track > 0 ? set_by_answers(trial.standard)
                                     : protocol.series[static_cast<std::size_t>(trial.series)].pair[0];
    const bool first_is_a = trial.stimuli[0] == a;
    ++cell.pairs[same ? (first_is_a ? 0U : 1U) : (first_is_a ? 2U : 3U)];
    ++(same ? cell.same : cell.different);
    ++(same ? balance.same : balance.different);
  }
  for (std::size_t i = 0; i < first_class.size(); ++i) {
    CellBalance& cell = balance.cells[i];
    if (!gets(plan, cell.condition)) continue;
    const bool is_first = cell.participants++ == 0;
    cell.least_same = is_first ? first_class[i] : std::min(cell.least_same, first_class[i]);
    cell.most_same = std::max(cell.most_same, first_class[i]);
  }
}

// transitions: null where nothing asks for them.
void count_order(const std::vector<int>& order, Table& positions, Table* transitions) {
  for (std::size_t p = 0; p < order.size(); ++p) {
    ++at(positions, order[p], static_cast<int>(p));
    if (transitions != nullptr && p > 0) ++at(*transitions, order[p - 1], order[p]);
  }
}

}  // namespace

CohortBalance balance_of_cohort(const Protocol& protocol, int participants, std::uint64_t seed, int session,
                                std::optional<int> group) {
  if (participants < 1) throw std::invalid_argument("a cohort has at least one participant");
  if (session < 1) throw std::invalid_argument("sessions are numbered from 1");
  CohortBalance balance;
  balance.group = group;
  balance.participants = participants;
  balance.conditions = conditions_of(protocol, group);
  balance.session = session;
  balance.seed = seed;
  const bool explores = !task_of(protocol.task.kind).has_trials();
  for (std::size_t s = 0; s < protocol.series.size(); ++s) {
    for (std::size_t c = 0; c < protocol.conditions.size(); ++c) {
      CellBalance cell;
      cell.series = static_cast<int>(s);
      cell.condition = static_cast<int>(c);
      balance.cells.push_back(cell);
    }
  }
  if (explores) balance.object_positions = square(protocol.explore->objects.size());
  balance.series_positions = square(protocol.series.size());
  if (protocol.design.arrangement == Arrangement::blocked) {
    balance.condition_positions = square(protocol.conditions.size());
    balance.condition_transitions = square(protocol.conditions.size());
  }

  const OrderAssignment assignment(protocol, seed, session, group);
  std::map<std::vector<int>, int> outer_orders, inner_orders;
  std::map<std::pair<std::vector<int>, std::vector<int>>, int> pairs;
  for (int participant = 1; participant <= participants; ++participant) {
    if (group && group_of(protocol, participant, seed) != group) {
      --balance.participants;
      continue;
    }
    const std::vector<int> outer = assignment.outer_order(participant);
    const std::vector<std::vector<int>> inner = assignment.inner_orders(participant, outer);
    ++outer_orders[outer];
    ++inner_orders[inner.front()];
    ++pairs[{outer, inner.front()}];
    if (explores) {
      count_order(outer, balance.condition_positions, &balance.condition_transitions);
      for (const std::vector<int>& objects : inner) count_order(objects, balance.object_positions, nullptr);
      continue;
    }
    count_trials(make_plan(protocol, participant, seed, session), protocol, balance);
    count_order(outer, balance.series_positions, nullptr);
    if (protocol.design.arrangement == Arrangement::blocked)
      for (const std::vector<int>& conditions : inner)
        count_order(conditions, balance.condition_positions, &balance.condition_transitions);
  }
  (explores ? balance.condition_orders : balance.series_orders) = by_use(outer_orders);
  (explores ? balance.object_orders : balance.condition_orders) = by_use(inner_orders);
  balance.different_pairs_of_orders = static_cast<int>(pairs.size());
  for (const auto& [pair, count] : pairs) balance.most_used_pair = std::max(balance.most_used_pair, count);

  // Cells are placed by all conditions; those that a group does not get are then left out.
  std::erase_if(balance.cells,
                [&](const CellBalance& cell) { return !has_condition(protocol, group, cell.condition); });
  balance.group_size = assignment.group_size();
  balance.pair_count = assignment.pair_count();
  return balance;
}

int balanced_at(const Protocol& protocol) {
  int members = 1;
  for (int group = 0; group < group_count(protocol); ++group) {
    const auto of = protocol.groups.empty() ? std::nullopt : std::optional<int>(group);
    const int size = OrderAssignment(protocol, 0, 1, of).group_size();
    if (size == 0) return 0;
    members = std::lcm(members, size);
  }
  return members * group_count(protocol);
}

// A cohort's balance as people read it.

namespace {

constexpr std::size_t kOrdersShown = 12;
constexpr std::size_t kColumns = 100;

template <typename Named>
std::string order_text(const std::vector<int>& order, const std::vector<Named>& all) {
  std::string text;
  for (const int item : order) {
    if (!text.empty()) text += " ";
    text += all[static_cast<std::size_t>(item)].name;
  }
  return text;
}

template <typename Named>
std::string orders_text(std::string_view title, const std::vector<OrderUse>& orders, const std::vector<Named>& all) {
  std::string text = fmt::format("{}: {} used\n", title, orders.size());
  std::string line;
  for (std::size_t i = 0; i < std::min(orders.size(), kOrdersShown); ++i) {
    const std::string item = fmt::format("  {} ({} x)", order_text(orders[i].order, all), orders[i].participants);
    if (!line.empty() && line.size() + item.size() > kColumns) {
      text += line + "\n";
      line.clear();
    }
    line += item;
  }
  text += line + "\n";
  if (orders.size() > kOrdersShown) text += fmt::format("  and {} more\n", orders.size() - kOrdersShown);
  return text;
}

template <typename Named>
std::string table_text(const std::vector<std::vector<int>>& table, const std::vector<Named>& rows,
                       const std::vector<std::string>& columns) {
  // Wide tables are told by their extremes: a table that wraps is not read.
  const std::size_t width = 9;
  const std::size_t name_width = 18;
  if (name_width + width * columns.size() > kColumns) {
    int least = table[0][0], most = table[0][0];
    for (const auto& row : table) {
      least = std::min(least, *std::min_element(row.begin(), row.end()));
      most = std::max(most, *std::max_element(row.begin(), row.end()));
    }
    return fmt::format("  every entry lies between {} and {}\n", least, most);
  }
  std::string text = fmt::format("  {:<{}}", "", name_width - 2);
  for (const std::string& column : columns) text += fmt::format("{:>{}}", column.substr(0, width - 1), width);
  text += "\n";
  for (std::size_t r = 0; r < table.size(); ++r) {
    text += fmt::format("  {:<{}}", rows[r].name.substr(0, name_width - 2), name_width - 2);
    for (const int count : table[r]) text += fmt::format("{:>{}}", count, width);
    text += "\n";
  }
  return text;
}

std::vector<std::string> positions(std::size_t count) {
  std::vector<std::string> titles;
  for (std::size_t i = 1; i <= count; ++i) titles.push_back(fmt::format("place {}", i));
  return titles;
}

// "120 to 121", or "120".
std::string range_of(int least, int most) {
  return least == most ? fmt::format("{}", most) : fmt::format("{} to {}", least, most);
}

std::string arrangements_text(const CohortBalance& balance, const Protocol& protocol) {
  std::string text = fmt::format(
      "Main trials: arrangements are the different stimuli and orders of a trial\n  {:<17}{:<17}{:>8}{:>14}{:>14}   {}\n",
      "series", "condition", "trials", "arrangements", "times each",
      protocol.task.classes.empty() ? "" : "correct answers");
  for (const CellBalance& cell : balance.cells) {
    int trials = 0, least = cell.arrangements.empty() ? 0 : cell.arrangements.begin()->second, most = 0;
    for (const auto& [arrangement, times] : cell.arrangements) {
      trials += times;
      least = std::min(least, times);
      most = std::max(most, times);
    }
    text +=
        fmt::format("  {:<17}{:<17}{:>8}{:>14}{:>14}  ", protocol.series[static_cast<std::size_t>(cell.series)].name,
                    condition_name(protocol, cell.condition), trials, cell.arrangements.size(), range_of(least, most));
    if (!cell.targets.empty()) {
      const auto [rarest, commonest] = std::minmax_element(cell.targets.begin(), cell.targets.end());
      text += fmt::format(" {} of each", range_of(*rarest, *commonest));
    }
    text += "\n";
  }
  return text;
}

std::string cells_text(const CohortBalance& balance, const Protocol& protocol) {
  if (!task_of(protocol.task.kind).has_pairs()) return arrangements_text(balance, protocol);
  std::string text = fmt::format(
      "{}\n  {:<17}{:<17}{:>12}",
      levels_given(protocol) ? "Stimuli of the main trials, a and b being the stiffnesses of the pair"
                             : "Trials planned at most: a is a comparison that the answers set, b the reference",
      "series", "condition", fmt::format("pair ({})", to_string(protocol.stimulus.unit)));
  for (const char* const title : {"aa", "bb", "ab", "ba"}) text += fmt::format("{:>7}", title);
  text += fmt::format("{:>20}\n", "same a participant");
  for (const CellBalance& cell : balance.cells) {
    const Series& series = protocol.series[static_cast<std::size_t>(cell.series)];
    const Condition& condition = protocol.conditions[static_cast<std::size_t>(cell.condition)];
    text += fmt::format("  {:<17}{:<17}{:>12}", series.name, condition.name,
                        plain(series.pair[0]) + " " + plain(series.pair[1]));
    for (const int count : cell.pairs) text += fmt::format("{:>7}", count);
    text += fmt::format("{:>20}\n", fmt::format("{} of {}", range_of(cell.least_same, cell.most_same),
                                                protocol.design.trials_per_cell));
  }
  const int all = balance.same + balance.different;
  text += fmt::format("  all: {} same, {} different ({:.1f} % same)\n", balance.same, balance.different,
                      all == 0 ? 0.0 : 100.0 * balance.same / all);
  return text;
}

std::string verdict(const CohortBalance& balance, std::string_view factors) {
  if (balance.group_size == 0)
    return "Random orders are balanced by chance only; \"permuted\" or \"williams\" orders are dealt evenly.\n";
  std::string text;
  const int over = balance.participants % balance.group_size;
  if (over == 0) {
    text += fmt::format("Exact: each order is used equally often by {} participants.", balance.participants);
  } else {
    text += fmt::format("Not exact: {} participants are not a multiple of {}; {} would be.", balance.participants,
                        balance.group_size, balance.participants - over + balance.group_size);
  }
  text += fmt::format("\nOrders are balanced at multiples of {}, pairs of {} orders at multiples of {}.\n",
                      balance.group_size, factors, balance.pair_count);
  return text;
}

struct Named {
  std::string name;
};

std::string explorations_text(const CohortBalance& balance, const Protocol& protocol) {
  std::vector<Named> objects;
  for (const std::string& name : protocol.explore->objects) objects.push_back({name});
  std::string text = orders_text("Orders of conditions", balance.condition_orders, protocol.conditions);
  text += "\nConditions by place in the session (participants)\n" +
          table_text(balance.condition_positions, protocol.conditions, positions(protocol.conditions.size()));
  text += "\n";
  text += orders_text("Orders of objects", balance.object_orders, objects);
  text += "\nObjects by place in a condition's turn (turns of all participants)\n" +
          table_text(balance.object_positions, objects, positions(objects.size()));
  text += fmt::format("\nPairs of orders: {} of {} participants differ; the commonest is shared by {}.\n",
                      balance.different_pairs_of_orders, balance.participants, balance.most_used_pair);
  return text;
}

std::string head(const CohortBalance& balance, const Protocol& protocol) {
  const std::string session = balance.session == 1 ? "" : fmt::format(", session {}", balance.session);
  const std::string group =
      balance.group ? fmt::format(" of group {}", group_name(protocol, balance.group)) : std::string();
  return fmt::format("Balance of {} participant{}{}, seed {}{}\n\n", balance.participants,
                     balance.participants == 1 ? "" : "s", group, balance.seed, session);
}

// The rows of the conditions that are there, and so many columns; or their own columns.
std::vector<std::vector<int>> part_of(const std::vector<std::vector<int>>& table, const std::vector<int>& conditions,
                                      bool by_condition) {
  std::vector<std::vector<int>> part;
  for (const int row : conditions) {
    const std::vector<int>& whole = table[static_cast<std::size_t>(row)];
    part.emplace_back();
    for (std::size_t i = 0; i < conditions.size(); ++i)
      part.back().push_back(whole[by_condition ? static_cast<std::size_t>(conditions[i]) : i]);
  }
  return part;
}

}  // namespace

std::string to_text(const CohortBalance& balance, const Protocol& protocol) {
  if (!balance.object_orders.empty())
    return head(balance, protocol) + explorations_text(balance, protocol) + verdict(balance, "condition and object");
  if (balance.participants == 0) return head(balance, protocol) + "Nobody is in it yet.\n";
  std::vector<Named> conditions;
  std::vector<std::string> names;
  for (const int condition : balance.conditions) {
    conditions.push_back({condition_name(protocol, condition)});
    names.push_back(conditions.back().name);
  }
  std::string text = head(balance, protocol);
  text += cells_text(balance, protocol) + "\n";
  text += orders_text("Orders of series", balance.series_orders, protocol.series);
  text += "\nSeries by place in the session (participants)\n" +
          table_text(balance.series_positions, protocol.series, positions(protocol.series.size())) + "\n";
  if (balance.condition_positions.empty()) {
    text += "Conditions are mixed within each series.\n";
  } else {
    text += orders_text("Orders of conditions (first series)", balance.condition_orders, protocol.conditions);
    text += "\nConditions by place in a series (series of all participants)\n" +
            table_text(part_of(balance.condition_positions, balance.conditions, false), conditions,
                       positions(conditions.size()));
    if (conditions.size() > 1) {
      text += "\nCondition of the row directly before that of the column (times)\n" +
              table_text(part_of(balance.condition_transitions, balance.conditions, true), conditions, names);
    }
    text += fmt::format("\nPairs of orders: {} of {} participants differ; the commonest is shared by {}.\n",
                        balance.different_pairs_of_orders, balance.participants, balance.most_used_pair);
  }
  return text + verdict(balance, "series and condition");
}

}  // namespace jnd
