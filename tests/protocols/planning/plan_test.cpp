// Plans: orders, runs, cohorts, allotment, and further sessions.
#include "protocols/planning/plan.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <stdexcept>

#include <fmt/format.h>
#include <rapidcheck.h>

#include "protocols/input/sha256.h"
#include "protocols/planning/order.h"
#include "protocols/reading/protocol_json.h"
#include "protocols/tasks/task.h"
#include "tests/catch.h"
#include "tests/protocols/examples.h"

using namespace jnd;
using namespace jnd::test;

namespace {

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

std::vector<Trial> main_trials(const Plan& plan) {
  std::vector<Trial> trials;
  std::copy_if(plan.trials.begin(), plan.trials.end(), std::back_inserter(trials),
               [](const Trial& t) { return !t.practice; });
  return trials;
}

// The stimuli of one cell in presented order, found by names.
std::vector<Intervals> cell_of(const Protocol& protocol, const Plan& plan, const std::string& series,
                               const std::string& condition) {
  std::vector<Intervals> cell;
  for (const Trial& trial : main_trials(plan)) {
    if (protocol.series[static_cast<std::size_t>(trial.series)].name == series &&
        protocol.conditions[static_cast<std::size_t>(trial.condition)].name == condition)
      cell.push_back(trial.stimuli);
  }
  return cell;
}

int longest_run_within_blocks(const std::vector<Trial>& trials) {
  int longest = 0, run = 0;
  for (std::size_t i = 0; i < trials.size(); ++i) {
    const bool goes_on = i > 0 && trials[i].block == trials[i - 1].block &&
                         (trials[i].target == kClassSame) == (trials[i - 1].target == kClassSame);
    run = goes_on ? run + 1 : 1;
    longest = std::max(longest, run);
  }
  return longest;
}

std::string digest(const Protocol& protocol, const Plan& plan) {
  std::string text;
  for (const Trial& trial : plan.trials) {
    text += fmt::format(
        "{} {} {} {:g} {:g}\n", trial.block, protocol.series[static_cast<std::size_t>(trial.series)].name,
        protocol.conditions[static_cast<std::size_t>(trial.condition)].name, trial.stimuli[0], trial.stimuli[1]);
  }
  return sha256_hex(text);
}

TEST_CASE("plans never change: literal trials and digests") {
  // Computed with an independent Python model of Philox, the streams' names and the rules of this room's README.
  const Protocol published = load_protocol(protocols_folder() / "chinello2017.json");
  const Plan plan = make_plan(published, 1, 1);
  REQUIRE(plan.trials.size() == 108);
  const std::array<Intervals, 6> first = {Intervals{700, 700}, {700, 700}, {900, 900},
                                          {900, 700},          {700, 700}, {700, 900}};
  for (std::size_t i = 0; i < first.size(); ++i) {
    CHECK(plan.trials[i].stimuli == first[i]);
    CHECK(plan.trials[i].series == 2);
    CHECK(plan.trials[i].condition == 2);
    CHECK(plan.trials[i].block == 1);
  }
  CHECK(plan.trials.back().stimuli == Intervals{900, 900});
  CHECK(plan.trials.back().series == 1);
  CHECK(plan.trials.back().condition == 0);
  CHECK(digest(published, plan) == "723be832b3637a48ecae85c5d96217aab41db3592b4152af0f9d07efd9e2e87d");
  CHECK(digest(published, make_plan(published, 18, 20171101)) ==
        "7072312f74f1e39208c1c938a424ad0fbab8817a486004d247791d226effd536");
  const Protocol balanced = load_protocol(protocols_folder() / "chinello2017-balanced.json");
  CHECK(digest(balanced, make_plan(balanced, 1, 1)) ==
        "a66e5dc2c9a9c73d82269e9b72c3f6ca40a30b57590e2ca96c3e188d2ecb31c3");
  CHECK(digest(balanced, make_plan(balanced, 40, 18446744073709551615U)) ==
        "4c40d844a3a10b1b88e59e52e8ada016d12ea11a5c9340794764a40c335adc64");
}

TEST_CASE("properties of any plan") {
  REQUIRE(rc::check("cells exact, blocks in order, run limits held", [] {
    const int series = *rc::gen::inRange(1, 5);
    const int conditions = *rc::gen::inRange(1, 5);
    const bool balanced = *rc::gen::arbitrary<bool>();
    const bool mixed = *rc::gen::arbitrary<bool>();
    const int trials = balanced ? 4 * *rc::gen::inRange(1, 9) : *rc::gen::inRange(2, 33);
    Protocol protocol = small_protocol(series, conditions, trials, balanced ? Sampling::balanced : Sampling::random);
    const auto order = rc::gen::element(Order::fixed, Order::random, Order::permuted, Order::williams);
    protocol.design.series_order = *order;
    protocol.design.arrangement = mixed ? Arrangement::mixed : Arrangement::blocked;
    protocol.design.condition_order = mixed ? Order::fixed : *order;
    protocol.design.per_series = !mixed && *rc::gen::arbitrary<bool>();
    if (balanced && *rc::gen::arbitrary<bool>()) protocol.design.run_limit = *rc::gen::inRange(1, 7);
    const int participant = *rc::gen::inRange(1, 200);
    const auto seed = *rc::gen::arbitrary<std::uint64_t>();

    const Plan plan = make_plan(protocol, participant, seed);
    RC_ASSERT(plan.trials == make_plan(protocol, participant, seed).trials);
    RC_ASSERT(static_cast<int>(plan.trials.size()) == series * conditions * trials);
    RC_ASSERT(
        std::is_permutation(plan.series_order.begin(), plan.series_order.end(), std::vector<int>{0, 1, 2, 3}.begin()));
    std::map<std::pair<int, int>, std::map<Intervals, int>> cells;
    for (std::size_t i = 0; i < plan.trials.size(); ++i) {
      const Trial& trial = plan.trials[i];
      const int per_block = mixed ? conditions * trials : trials;
      RC_ASSERT(trial.index == static_cast<int>(i) + 1);
      RC_ASSERT(trial.block == static_cast<int>(i) / per_block + 1);
      RC_ASSERT(!trial.practice);
      RC_ASSERT(trial.round == 0);
      RC_ASSERT((trial.target == kClassSame) == (trial.stimuli[0] == trial.stimuli[1]));
      const auto series_turn = i / static_cast<std::size_t>(conditions * trials);
      RC_ASSERT(trial.series == plan.series_order[series_turn]);
      if (!mixed) {
        const auto condition_turn = i / static_cast<std::size_t>(trials) % static_cast<std::size_t>(conditions);
        RC_ASSERT(trial.condition == plan.condition_orders[series_turn][condition_turn]);
      }
      const auto& pair = protocol.series[static_cast<std::size_t>(trial.series)].pair;
      for (const double stiffness : trial.stimuli) RC_ASSERT(stiffness == pair[0] || stiffness == pair[1]);
      ++cells[{trial.series, trial.condition}][trial.stimuli];
    }
    RC_ASSERT(static_cast<int>(cells.size()) == series * conditions);
    for (const auto& [cell, pairs] : cells) {
      int sum = 0;
      for (const auto& [pair, count] : pairs) {
        sum += count;
        if (balanced) RC_ASSERT(count == trials / 4);
      }
      RC_ASSERT(sum == trials);
      if (balanced) RC_ASSERT(pairs.size() == std::size_t{4});
    }
    if (protocol.design.run_limit) RC_ASSERT(longest_run_within_blocks(plan.trials) <= *protocol.design.run_limit);
  }));
}

TEST_CASE("draws of a cell do not depend on other conditions, series or participants") {
  for (const Sampling sampling : {Sampling::random, Sampling::balanced}) {
    for (const bool limited : {false, true}) {
      if (limited && sampling == Sampling::random) continue;
      Protocol protocol = small_protocol(3, 3, 12, sampling);
      protocol.design.series_order = protocol.design.condition_order = Order::permuted;
      if (limited) protocol.design.run_limit = 3;
      Protocol changed = protocol;
      changed.conditions.erase(changed.conditions.begin());  // one fewer
      changed.conditions.back().name = "renamed";            // another name
      changed.conditions.insert(changed.conditions.begin(), {Condition{"new", "", {true, true}}});
      changed.series.push_back({"extra", {333, 900}});
      changed.design.participants = 99;
      for (int participant = 1; participant <= 12; ++participant) {
        const Plan plan = make_plan(protocol, participant, 8);
        const Plan other = make_plan(changed, participant, 8);
        for (const std::string series : {"s0", "s1", "s2"})
          CHECK(cell_of(protocol, plan, series, "c1") == cell_of(changed, other, series, "c1"));
        CHECK(cell_of(changed, other, "s0", "renamed") != cell_of(protocol, plan, "s0", "c2"));
        CHECK(cell_of(protocol, plan, "s0", "c0") != cell_of(protocol, plan, "s0", "c1"));
        CHECK(cell_of(protocol, plan, "s0", "c0") !=
              cell_of(protocol, make_plan(protocol, participant + 1, 8), "s0", "c0"));
        CHECK(cell_of(protocol, plan, "s0", "c0") !=
              cell_of(protocol, make_plan(protocol, participant, 9), "s0", "c0"));
      }
    }
  }
}

TEST_CASE("mixed blocks keep each condition's own draws") {
  Protocol blocked = small_protocol(2, 3, 16, Sampling::balanced);
  Protocol mixed = blocked;
  mixed.design.arrangement = Arrangement::mixed;
  for (int participant = 1; participant <= 10; ++participant) {
    const Plan apart = make_plan(blocked, participant, 3);
    const Plan together = make_plan(mixed, participant, 3);
    for (const std::string condition : {"c0", "c1", "c2"})
      CHECK(cell_of(blocked, apart, "s1", condition) == cell_of(mixed, together, "s1", condition));
    const auto trials = main_trials(together);
    CHECK(trials.back().block == 2);
    std::set<int> early;
    for (std::size_t i = 0; i < 16; ++i) early.insert(trials[i].condition);
    CHECK(early.size() == 3);
  }
}

TEST_CASE("random draws: independent fair spheres, so that half of the trials are same") {
  const Protocol protocol = small_protocol(1, 1, 2000, Sampling::random);
  std::map<Intervals, int> pairs;
  for (int participant = 1; participant <= 20; ++participant)
    for (const Trial& trial : make_plan(protocol, participant, 4).trials) ++pairs[trial.stimuli];
  CHECK(pairs.size() == 4);
  for (const auto& [pair, count] : pairs) CHECK(std::abs(count - 10000) < 5 * 87);  // SD 86.6
}

TEST_CASE("run limits do not favour a class or a place") {
  Protocol protocol = small_protocol(1, 1, 8, Sampling::balanced);
  protocol.design.run_limit = 2;
  std::vector<int> same_at(8, 0);
  constexpr int kParticipants = 4000;
  for (int participant = 1; participant <= kParticipants; ++participant) {
    const Plan plan = make_plan(protocol, participant, 5);
    REQUIRE(longest_run_within_blocks(plan.trials) <= 2);
    for (std::size_t i = 0; i < 8; ++i) same_at[i] += (plan.trials[i].target == kClassSame) ? 1 : 0;
  }
  // By symmetry of the classes each place is "same" half of the time; SD 31.6.
  for (const int count : same_at) CHECK(std::abs(count - kParticipants / 2) < 5 * 32);
}

TEST_CASE("practice comes first, in rounds, conditions in turn, about half same") {
  for (const int trials : {1, 2, 3, 4, 6, 8, 12}) {
    CAPTURE(trials);
    Protocol protocol = small_protocol(2, 3, 4, Sampling::balanced);
    protocol.practice = Practice{trials, 1, {2, 0}, 0.75, 3, Feedback::correctness};
    int same_of_all = 0;
    for (int participant = 1; participant <= 100; ++participant) {
      const Plan plan = make_plan(protocol, participant, 6);
      REQUIRE(static_cast<int>(plan.trials.size()) == 3 * trials + 2 * 3 * 4);
      for (int round = 1; round <= 3; ++round) {
        int same = 0;
        for (int i = 0; i < trials; ++i) {
          const Trial& trial = plan.trials[static_cast<std::size_t>((round - 1) * trials + i)];
          CHECK(trial.practice);
          CHECK(trial.round == round);
          CHECK(trial.block == 0);
          CHECK(trial.series == 1);
          CHECK(trial.condition == (i % 2 == 0 ? 2 : 0));
          CHECK(trial.index == (round - 1) * trials + i + 1);
          same += (trial.target == kClassSame) ? 1 : 0;
        }
        same_of_all += same;
        if (trials % 4 == 0) CHECK(same == trials / 2);
        if (trials >= 2) {
          CHECK(same > 0);
          CHECK(same < trials);
        }
      }
      CHECK(plan.trials[static_cast<std::size_t>(3 * trials)].block == 1);
      Protocol without = protocol;
      without.practice.reset();
      const auto bare = main_trials(make_plan(without, participant, 6));
      const auto with = main_trials(plan);
      for (std::size_t i = 0; i < bare.size(); ++i) CHECK(bare[i].stimuli == with[i].stimuli);
    }
    CHECK(std::abs(same_of_all - 150 * trials) <= 5 * std::sqrt(75.0 * trials));
  }
}

TEST_CASE("participants are numbered from 1") {
  const Protocol protocol = small_protocol(1, 1, 4, Sampling::balanced);
  CHECK_THROWS_AS(make_plan(protocol, 0, 1), std::invalid_argument);
  CHECK_THROWS_AS(make_plan(protocol, -3, 1), std::invalid_argument);
}

int longest_run(const std::vector<bool>& sequence) {
  int longest = 0, run = 0;
  for (std::size_t i = 0; i < sequence.size(); ++i) {
    run = i > 0 && sequence[i] == sequence[i - 1] ? run + 1 : 1;
    longest = std::max(longest, run);
  }
  return longest;
}

// By listing all arrangements.
std::vector<std::vector<bool>> all_limited(int same, int different, int limit) {
  std::vector<bool> sequence(static_cast<std::size_t>(different), false);
  sequence.insert(sequence.end(), static_cast<std::size_t>(same), true);
  std::vector<std::vector<bool>> all;
  do {
    if (longest_run(sequence) <= limit) all.push_back(sequence);
  } while (std::next_permutation(sequence.begin(), sequence.end()));
  return all;
}

TEST_CASE("sequences are drawn wherever listing finds some, and are among those listed") {
  for (int same = 0; same <= 6; ++same)
    for (int different = 0; different <= 6; ++different)
      for (int limit = 1; limit <= 7; ++limit) {
        CAPTURE(same, different, limit);
        const auto all = all_limited(same, different, limit);
        RandomStream stream(7, 1, "test");
        if (all.empty()) CHECK_THROWS_AS(draw_limited_sequence(same, different, limit, stream), std::invalid_argument);
        for (int draw = 0; draw < 5 && !all.empty(); ++draw)
          CHECK(std::count(all.begin(), all.end(), draw_limited_sequence(same, different, limit, stream)) == 1);
      }
}

TEST_CASE("limited sequences are drawn uniformly among all that exist") {
  struct Case {
    int same, different, limit;
  };
  for (const Case one : {Case{4, 4, 2}, Case{4, 4, 3}, Case{3, 5, 2}, Case{4, 4, 8}, Case{6, 3, 2}, Case{5, 5, 1},
                         Case{2, 6, 4}, Case{6, 6, 3}}) {
    CAPTURE(one.same, one.different, one.limit);
    const auto all = all_limited(one.same, one.different, one.limit);
    const int each = 400;
    std::map<std::vector<bool>, int> counts;
    for (std::size_t draw = 0; draw < all.size() * each; ++draw) {
      RandomStream stream(11, 1, "test", draw);
      const auto sequence = draw_limited_sequence(one.same, one.different, one.limit, stream);
      REQUIRE(longest_run(sequence) <= one.limit);
      REQUIRE(std::count(sequence.begin(), sequence.end(), true) == one.same);
      ++counts[sequence];
    }
    REQUIRE(counts.size() == all.size());
    double chi_squared = 0;
    for (const auto& [sequence, count] : counts) chi_squared += std::pow(count - each, 2) / each;
    const double freedom = static_cast<double>(all.size()) - 1;
    CHECK(std::abs(chi_squared - freedom) < 5 * std::sqrt(2 * freedom));
  }
}

TEST_CASE("long blocks keep their limit") {
  for (const int limit : {1, 2, 4, 10}) {
    RandomStream stream(1, 1, "test");
    const auto sequence = draw_limited_sequence(500, 500, limit, stream);
    CHECK(sequence.size() == 1000);
    CHECK(std::count(sequence.begin(), sequence.end(), true) == 500);
    CHECK(longest_run(sequence) <= limit);
  }
}

TEST_CASE("impossible run limits are refused") {
  RandomStream stream(1, 1, "test");
  CHECK_THROWS_AS(draw_limited_sequence(5, 1, 2, stream), std::invalid_argument);
  CHECK_THROWS_AS(draw_limited_sequence(2, 2, 0, stream), std::invalid_argument);
  CHECK_THROWS_AS(draw_limited_sequence(501, 500, 4, stream), std::invalid_argument);
  CHECK_THROWS_AS(draw_limited_sequence(-1, 2, 4, stream), std::invalid_argument);
  CHECK(draw_limited_sequence(0, 0, 3, stream).empty());
}

}  // namespace
