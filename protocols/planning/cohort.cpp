#include "protocols/planning/cohort.h"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <utility>

#include "protocols/planning/exploration_deal.h"
#include "protocols/planning/order.h"
#include "protocols/planning/plan.h"

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

void count_trials(const Plan& plan, const Protocol& protocol, CohortBalance& balance) {
  std::vector<int> same_of_cell(balance.cells.size(), 0);
  for (const Trial& trial : plan.trials) {
    if (trial.practice) continue;
    const std::size_t cell =
        static_cast<std::size_t>(trial.series) * protocol.conditions.size() + static_cast<std::size_t>(trial.condition);
    // Of an adaptive procedure a is the comparison, whatever its level.
    const double a = trial.track > 0 ? kSetByAnswers : protocol.series[static_cast<std::size_t>(trial.series)].pair[0];
    const bool first_is_a = trial.stimuli[0] == a;
    ++balance.cells[cell].pairs[trial.same ? (first_is_a ? 0U : 1U) : (first_is_a ? 2U : 3U)];
    ++(trial.same ? balance.cells[cell].same : balance.cells[cell].different);
    ++(trial.same ? balance.same : balance.different);
    if (trial.same) ++same_of_cell[cell];
  }
  for (std::size_t i = 0; i < same_of_cell.size(); ++i) {
    CellBalance& cell = balance.cells[i];
    const bool is_first = plan.participant == 1;
    cell.least_same = is_first ? same_of_cell[i] : std::min(cell.least_same, same_of_cell[i]);
    cell.most_same = std::max(cell.most_same, same_of_cell[i]);
  }
}

void count_positions(const Plan& plan, const Protocol& protocol, CohortBalance& balance) {
  for (std::size_t j = 0; j < plan.series_order.size(); ++j) {
    ++at(balance.series_positions, plan.series_order[j], static_cast<int>(j));
    if (protocol.design.arrangement == Arrangement::mixed) continue;
    const std::vector<int>& order = plan.condition_orders[j];
    for (std::size_t p = 0; p < order.size(); ++p) {
      ++at(balance.condition_positions, order[p], static_cast<int>(p));
      if (p > 0) ++at(balance.condition_transitions, order[p - 1], order[p]);
    }
  }
}

// Conditions and objects of free interaction.
void count_explorations(const Protocol& protocol, CohortBalance& balance) {
  balance.condition_positions = square(protocol.conditions.size());
  balance.condition_transitions = square(protocol.conditions.size());
  const ExplorationDeal deal(protocol, balance.seed, balance.session);
  balance.object_positions = square(protocol.explore->objects.size());
  std::map<std::vector<int>, int> condition_orders, object_orders;
  std::map<std::pair<std::vector<int>, std::vector<int>>, int> pairs;
  for (int participant = 1; participant <= balance.participants; ++participant) {
    const std::vector<int> conditions = deal.condition_order(participant), objects = deal.object_order(participant);
    ++condition_orders[conditions];
    ++object_orders[objects];
    ++pairs[{conditions, objects}];
    for (std::size_t p = 0; p < conditions.size(); ++p) {
      ++at(balance.condition_positions, conditions[p], static_cast<int>(p));
      if (p > 0) ++at(balance.condition_transitions, conditions[p - 1], conditions[p]);
      for (std::size_t q = 0; q < objects.size(); ++q) ++at(balance.object_positions, objects[q], static_cast<int>(q));
    }
  }
  balance.condition_orders = by_use(condition_orders);
  balance.object_orders = by_use(object_orders);
  balance.different_pairs_of_orders = static_cast<int>(pairs.size());
  for (const auto& [pair, count] : pairs) balance.most_used_pair = std::max(balance.most_used_pair, count);
  balance.group_size = deal.group_size();
  balance.pair_count = deal.pair_count();
}

}  // namespace

CohortBalance balance_of_cohort(const Protocol& protocol, int participants, std::uint64_t seed, int session) {
  if (participants < 1) throw std::invalid_argument("a cohort has at least one participant");
  if (session < 1) throw std::invalid_argument("sessions are numbered from 1");
  CohortBalance balance;
  balance.participants = participants;
  balance.session = session;
  balance.seed = seed;
  if (protocol.paradigm == Paradigm::explore) {
    count_explorations(protocol, balance);
    return balance;
  }
  for (std::size_t s = 0; s < protocol.series.size(); ++s) {
    for (std::size_t c = 0; c < protocol.conditions.size(); ++c) {
      CellBalance cell;
      cell.series = static_cast<int>(s);
      cell.condition = static_cast<int>(c);
      balance.cells.push_back(cell);
    }
  }
  balance.series_positions = square(protocol.series.size());
  if (protocol.design.arrangement == Arrangement::blocked) {
    balance.condition_positions = square(protocol.conditions.size());
    balance.condition_transitions = square(protocol.conditions.size());
  }

  std::map<std::vector<int>, int> series_orders, condition_orders;
  std::map<std::pair<std::vector<int>, std::vector<int>>, int> pairs;
  for (int participant = 1; participant <= participants; ++participant) {
    const Plan plan = make_plan(protocol, participant, seed, session);
    ++series_orders[plan.series_order];
    ++condition_orders[plan.condition_orders.front()];
    ++pairs[{plan.series_order, plan.condition_orders.front()}];
    count_trials(plan, protocol, balance);
    count_positions(plan, protocol, balance);
  }
  balance.series_orders = by_use(series_orders);
  balance.condition_orders = by_use(condition_orders);
  balance.different_pairs_of_orders = static_cast<int>(pairs.size());
  for (const auto& [pair, count] : pairs) balance.most_used_pair = std::max(balance.most_used_pair, count);

  const OrderDeal deal(protocol, seed, session);
  const bool random = deal.series_list().empty() || deal.condition_list().empty();
  balance.group_size = random ? 0 : deal.group_size();
  balance.pair_count = random ? 0 : deal.pair_count();
  return balance;
}

}  // namespace jnd
