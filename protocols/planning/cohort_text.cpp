// A cohort's balance as people read it.
#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "protocols/planning/cohort.h"
#include "protocols/input/json_reader.h"

namespace jnd {
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

std::string cells_text(const CohortBalance& balance, const Protocol& protocol) {
  std::string text = fmt::format("{}\n  {:<17}{:<17}{:>12}",
                                 protocol.design.procedure
                                     ? "Trials planned at most: a is a comparison that the answers set, b the reference"
                                     : "Stimuli of the main trials, a and b being the stiffnesses of the pair",
                                 "series", "condition", fmt::format("pair ({})", to_string(protocol.stimulus.unit)));
  for (const char* const title : {"aa", "bb", "ab", "ba"}) text += fmt::format("{:>7}", title);
  text += fmt::format("{:>20}\n", "same a participant");
  for (const CellBalance& cell : balance.cells) {
    const Series& series = protocol.series[static_cast<std::size_t>(cell.series)];
    const Condition& condition = protocol.conditions[static_cast<std::size_t>(cell.condition)];
    text += fmt::format("  {:<17}{:<17}{:>12}", series.name, condition.name,
                        plain(series.pair[0]) + " " + plain(series.pair[1]));
    for (const int count : cell.pairs) text += fmt::format("{:>7}", count);
    const std::string range = cell.least_same == cell.most_same
                                  ? fmt::format("{}", cell.most_same)
                                  : fmt::format("{} to {}", cell.least_same, cell.most_same);
    text += fmt::format("{:>20}\n", fmt::format("{} of {}", range, protocol.design.trials_per_cell));
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
  text += "\n" + orders_text("Orders of objects", balance.object_orders, objects);
  text += "\nObjects by place in a condition's turn (turns of all participants)\n" +
          table_text(balance.object_positions, objects, positions(objects.size()));
  text += fmt::format("\nPairs of orders: {} of {} participants differ; the commonest is shared by {}.\n",
                      balance.different_pairs_of_orders, balance.participants, balance.most_used_pair);
  return text;
}

std::string head(const CohortBalance& balance) {
  const std::string session = balance.session == 1 ? "" : fmt::format(", session {}", balance.session);
  return fmt::format("Balance of {} participants, seed {}{}\n\n", balance.participants, balance.seed, session);
}

}  // namespace

std::string to_text(const CohortBalance& balance, const Protocol& protocol) {
  if (protocol.paradigm == Paradigm::explore)
    return head(balance) + explorations_text(balance, protocol) + verdict(balance, "condition and object");
  std::string text = head(balance);
  text += cells_text(balance, protocol) + "\n";
  text += orders_text("Orders of series", balance.series_orders, protocol.series);
  text += "\nSeries by place in the session (participants)\n" +
          table_text(balance.series_positions, protocol.series, positions(protocol.series.size())) + "\n";
  if (balance.condition_positions.empty()) {
    text += "Conditions are mixed within each series.\n";
  } else {
    text += orders_text("Orders of conditions (first series)", balance.condition_orders, protocol.conditions);
    text += "\nConditions by place in a series (series of all participants)\n" +
            table_text(balance.condition_positions, protocol.conditions, positions(protocol.conditions.size()));
    if (protocol.conditions.size() > 1) {
      std::vector<std::string> names;
      for (const Condition& condition : protocol.conditions) names.push_back(condition.name);
      text += "\nCondition of the row directly before that of the column (times)\n" +
              table_text(balance.condition_transitions, protocol.conditions, names);
    }
    text += fmt::format("\nPairs of orders: {} of {} participants differ; the commonest is shared by {}.\n",
                        balance.different_pairs_of_orders, balance.participants, balance.most_used_pair);
  }
  return text + verdict(balance, "series and condition");
}

}  // namespace jnd
