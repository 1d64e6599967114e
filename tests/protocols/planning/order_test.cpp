#include "protocols/planning/order.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "protocols/planning/plan.h"
#include "tests/catch.h"
#include "tests/protocols/examples.h"

using namespace jnd;
using namespace jnd::test;

TEST_CASE("a Williams square balances positions and neighbours exactly") {
  for (int k = 1; k <= 9; ++k) {
    CAPTURE(k);
    const OrderList square = williams_square(k);
    CHECK(static_cast<int>(square.size()) == (k == 1 ? 1 : (k % 2 == 0 ? k : 2 * k)));
    std::map<std::pair<int, int>, int> at_position, before;
    for (const auto& order : square) {
      CHECK(std::set<int>(order.begin(), order.end()).size() == static_cast<std::size_t>(k));
      for (std::size_t p = 0; p < order.size(); ++p) {
        ++at_position[{order[p], static_cast<int>(p)}];
        if (p > 0) ++before[{order[p - 1], order[p]}];
      }
    }
    const int repeats = k % 2 == 0 || k == 1 ? 1 : 2;
    CHECK(static_cast<int>(at_position.size()) == k * k);
    for (const auto& [place, count] : at_position) CHECK(count == repeats);
    CHECK(static_cast<int>(before.size()) == k * (k - 1));
    for (const auto& [pair, count] : before) CHECK(count == repeats);
  }
}

TEST_CASE("permutations are all there, once") {
  for (int k = 1, factorial = 1; k <= 6; ++k, factorial *= k) {
    const OrderList all = all_permutations(k);
    CHECK(static_cast<int>(std::set<std::vector<int>>(all.begin(), all.end()).size()) == factorial);
    CHECK(static_cast<int>(all.size()) == factorial);
  }
}

TEST_CASE("three series and three conditions: participant 6r + s takes series order s and condition order s + r") {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    Protocol protocol = small_protocol(3, 3, 4, Sampling::balanced);
    protocol.design.series_order = protocol.design.condition_order = Order::permuted;
    const OrderAssignment assignment(protocol, seed);
    CHECK(assignment.group_size() == 6);
    CHECK(assignment.pair_count() == 36);
    for (int r = 0; r < 12; ++r) {
      for (int s = 0; s < 6; ++s) {
        const int participant = 6 * r + s + 1;
        CHECK(assignment.outer_place(participant) == s);
        CHECK(assignment.inner_place(participant) == (s + r) % 6);
      }
    }
  }
}

TEST_CASE("assigned orders: groups are balanced, all pairs occur before any repeats") {
  struct Case {
    int series, conditions;
    Order series_order, condition_order;
    int series_orders, condition_orders;
  };
  const std::vector<Case> cases = {
      {3, 3, Order::permuted, Order::permuted, 6, 6},  {3, 4, Order::permuted, Order::permuted, 6, 24},
      {4, 3, Order::permuted, Order::permuted, 24, 6}, {2, 3, Order::permuted, Order::williams, 2, 6},
      {4, 4, Order::williams, Order::williams, 4, 4},  {5, 4, Order::williams, Order::williams, 10, 4},
      {1, 3, Order::fixed, Order::permuted, 1, 6},     {3, 2, Order::fixed, Order::fixed, 1, 1},
      {5, 3, Order::williams, Order::permuted, 10, 6}, {2, 2, Order::permuted, Order::permuted, 2, 2},
      {6, 4, Order::williams, Order::williams, 6, 4},
  };
  for (const Case& one : cases) {
    for (const std::uint64_t seed : {0U, 1U, 99U}) {
      CAPTURE(one.series, one.conditions, one.series_orders, one.condition_orders, seed);
      Protocol protocol = small_protocol(one.series, one.conditions, 4, Sampling::balanced);
      protocol.design.series_order = one.series_order;
      protocol.design.condition_order = one.condition_order;
      const OrderAssignment assignment(protocol, seed);
      REQUIRE(static_cast<int>(assignment.outer_list().size()) == one.series_orders);
      REQUIRE(static_cast<int>(assignment.inner_list().size()) == one.condition_orders);
      CHECK(assignment.group_size() == std::lcm(one.series_orders, one.condition_orders));
      CHECK(assignment.pair_count() == one.series_orders * one.condition_orders);

      // What participants really get, not where they stand in the lists.
      std::map<std::pair<std::vector<int>, std::vector<int>>, int> pairs;
      std::map<std::vector<int>, int> series, conditions;
      for (int participant = 1; participant <= assignment.pair_count(); ++participant) {
        const auto series_order = assignment.outer_order(participant);
        const auto condition_order = assignment.inner_orders(participant, series_order).front();
        CHECK(++pairs[{series_order, condition_order}] == 1);
        ++series[series_order];
        ++conditions[condition_order];
        if (participant % assignment.group_size() != 0) continue;
        REQUIRE(static_cast<int>(series.size()) == one.series_orders);
        REQUIRE(static_cast<int>(conditions.size()) == one.condition_orders);
        for (const auto& [order, count] : series) CHECK(count == participant / one.series_orders);
        for (const auto& [order, count] : conditions) CHECK(count == participant / one.condition_orders);
      }
      CHECK(static_cast<int>(pairs.size()) == assignment.pair_count());
    }
  }
}

TEST_CASE("seeds shuffle the lists") {
  Protocol protocol = small_protocol(3, 3, 4, Sampling::balanced);
  protocol.design.series_order = Order::permuted;
  protocol.design.condition_order = Order::williams;
  std::map<std::vector<int>, int> first_series, first_conditions;
  for (std::uint64_t seed = 0; seed < 600; ++seed) {
    const OrderAssignment assignment(protocol, seed);
    const auto series = assignment.outer_order(1);
    ++first_series[series];
    ++first_conditions[assignment.inner_orders(1, series).front()];
  }
  // Each of 6 orders 100 times, SD 9.1.
  CHECK(first_series.size() == 6);
  CHECK(first_conditions.size() == 6);
  for (const auto& [order, count] : first_series) CHECK(std::abs(count - 100) < 46);
  for (const auto& [order, count] : first_conditions) CHECK(std::abs(count - 100) < 46);
}

TEST_CASE("one condition order serves all series unless per_series") {
  Protocol protocol = small_protocol(3, 3, 4, Sampling::balanced);
  protocol.design.condition_order = Order::permuted;
  protocol.design.series_order = Order::permuted;
  for (int participant = 1; participant <= 40; ++participant) {
    const Plan plan = make_plan(protocol, participant, 5);
    CHECK(plan.condition_orders == std::vector<std::vector<int>>(3, plan.condition_orders.front()));
  }
  protocol.design.per_series = true;
  const OrderAssignment assignment(protocol, 5);
  for (int participant = 1; participant <= 40; ++participant) {
    const Plan plan = make_plan(protocol, participant, 5);
    const auto& list = assignment.inner_list();
    for (std::size_t j = 0; j < 3; ++j) {
      const auto place = static_cast<std::size_t>(assignment.inner_place(participant)) + j;
      CHECK(plan.condition_orders[j] == list[place % list.size()]);
    }
  }
}

TEST_CASE("random orders are drawn anew for each participant, and for each series with per_series") {
  Protocol protocol = small_protocol(3, 3, 4, Sampling::balanced);
  protocol.design.series_order = protocol.design.condition_order = Order::random;
  std::map<std::vector<int>, int> series, conditions;
  int equal_within = 0;
  for (int participant = 1; participant <= 600; ++participant) {
    const Plan plan = make_plan(protocol, participant, 1);
    ++series[plan.series_order];
    ++conditions[plan.condition_orders.front()];
    CHECK(plan.condition_orders[0] == plan.condition_orders[1]);
    protocol.design.per_series = true;
    const Plan varied = make_plan(protocol, participant, 1);
    if (varied.condition_orders[0] == varied.condition_orders[1]) ++equal_within;
    protocol.design.per_series = false;
  }
  CHECK(series.size() == 6);
  CHECK(conditions.size() == 6);
  for (const auto& [order, count] : series) CHECK(std::abs(count - 100) < 46);
  for (const auto& [order, count] : conditions) CHECK(std::abs(count - 100) < 46);
  CHECK(std::abs(equal_within - 100) < 46);
}
