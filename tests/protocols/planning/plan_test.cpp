#include "protocols/planning/plan.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>

#include <fmt/format.h>
#include <rapidcheck.h>

#include "protocols/input/sha256.h"
#include "protocols/reading/protocol_json.h"
#include "protocols/tasks/task.h"
#include "tests/catch.h"
#include "tests/protocols/examples.h"

using namespace jnd;
using namespace jnd::test;

namespace {

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

}  // namespace

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
