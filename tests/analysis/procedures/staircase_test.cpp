#include "analysis/procedures/staircase.h"

#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include <rapidcheck.h>

#include "analysis/selftest/reference_numbers.h"
#include "protocols/random_stream.h"
#include "tests/catch.h"

using namespace jnd;

namespace {

struct Levels {
  std::vector<double> levels, reversals;
  double next = 0;
};

// answers: '1' correct, '0' wrong.
Levels levels_of(const StaircaseRule& rule, std::string_view answers) {
  Levels all;
  Staircase run(rule);
  for (const char answer : answers) {
    all.levels.push_back(run.level());
    run.answer(answer == '1');
  }
  all.reversals = run.reversals();
  all.next = run.level();
  return all;
}

StaircaseRule rule_of(double start, int up, int down, double step_up, double step_down) {
  StaircaseRule rule;
  rule.start = start;
  rule.up = up;
  rule.down = down;
  rule.step_up = step_up;
  rule.step_down = step_down;
  return rule;
}

// An observer whose probability of a correct answer is a cumulative logistic of the level, and the mean level of a long
// run from `settled` on.
double settled_level(const StaircaseRule& rule, double threshold, double width, int trials, int settled) {
  RandomStream stream(20, 1, "observer");
  Staircase run(rule);
  double sum = 0;
  for (int i = 0; i < trials; ++i) {
    if (i >= settled) sum += run.level();
    const double p = 1 / (1 + std::exp(-(run.level() - threshold) / width));
    run.answer(stream.uniform() < p);
  }
  return sum / (trials - settled);
}

}  // namespace

TEST_CASE("reference staircases are met exactly") {
  const nlohmann::json& reference = reference_numbers("adaptive").at("staircases");
  int runs = 0;
  for (const nlohmann::json& run : reference.at("runs")) {
    StaircaseRule rule = rule_of(reference.at("start"), run.at("up"), run.at("down"), run.at("step"), run.at("step"));
    rule.clamp = reference.at("clamp").get<std::array<double, 2>>();
    rule.halve_after = run.at("halve_after").get<std::vector<int>>();
    const Levels found = levels_of(rule, reference.at("answers").get<std::string>());
    CHECK(found.levels == run.at("levels").get<std::vector<double>>());
    CHECK(found.reversals == run.at("reversals").get<std::vector<double>>());
    CHECK(found.next == run.at("next").get<double>());
    CHECK(staircase_target(rule) == Approx(reference_number(run.at("target"))).epsilon(1e-13));
    ++runs;
  }
  CHECK(runs == 2);
}

TEST_CASE("wrong and correct answers count in a row only") {
  const StaircaseRule rule = rule_of(10, 2, 3, 1, 1);
  const Levels found = levels_of(rule, "0100111011100");
  //                       0   1   0   0   1   1   1   0   1   1   1  0  0
  CHECK(found.levels == std::vector<double>{10, 10, 10, 10, 11, 11, 11, 10, 10, 10, 10, 9, 9});
  CHECK(found.reversals == std::vector<double>{11, 9});
  CHECK(found.next == 10);
}

TEST_CASE("steps that multiply are halved on their logarithm, and both steps are halved") {
  StaircaseRule rule = rule_of(100, 1, 1, 4, 16);
  rule.multiplicative = true;
  rule.halve_after = {1};
  // Up by 4, then the first reversal: down by 4 instead of 16, then up by 2 instead of 4.
  CHECK(levels_of(rule, "010").levels == std::vector<double>{100, 400, 100});
  CHECK(levels_of(rule, "010").next == 200);
  StaircaseRule adding = rule_of(100, 1, 1, 20, 40);
  adding.halve_after = {1};
  CHECK(levels_of(adding, "010").levels == std::vector<double>{100, 120, 100});
  CHECK(levels_of(adding, "010").next == 110);
}

TEST_CASE("the clamp holds levels, and steps that it swallows are counted") {
  StaircaseRule rule = rule_of(20, 1, 1, 15, 15);
  rule.clamp = std::array<double, 2>{10, 40};
  Staircase run(rule);
  std::vector<double> levels;
  for (const bool correct : {true, true, true, false, false, false}) {
    run.answer(correct);
    levels.push_back(run.level());
  }
  CHECK(levels == std::vector<double>{10, 10, 10, 25, 40, 40});
  CHECK(run.steps() == 6);
  CHECK(run.reversals() == std::vector<double>{10});
}

TEST_CASE("target probabilities are those of Levitt and Kaernbach") {
  // Levitt (1971), table I: p^n = 1/2, and its mirror image.
  CHECK(staircase_target(rule_of(1, 1, 2, 1, 1)) == Approx(0.70710678).margin(1e-8));
  CHECK(staircase_target(rule_of(1, 1, 3, 1, 1)) == Approx(0.79370053).margin(1e-8));
  CHECK(staircase_target(rule_of(1, 1, 4, 1, 1)) == Approx(0.84089642).margin(1e-8));
  CHECK(staircase_target(rule_of(1, 2, 1, 1, 1)) == Approx(1 - 0.70710678).margin(1e-8));
  CHECK(staircase_target(rule_of(1, 1, 1, 1, 1)) == Approx(0.5).margin(1e-12));
  CHECK(staircase_target(rule_of(1, 2, 2, 1, 1)) == Approx(0.5).margin(1e-12));
  // Kaernbach (1991), equation 1: S_up p = S_down (1 - p) with the roles of his up and down.
  CHECK(staircase_target(rule_of(1, 1, 1, 3, 1)) == Approx(0.75).margin(1e-12));
  StaircaseRule weighted = rule_of(1, 1, 1, 8, 2);  // log 8 = 3 log 2
  weighted.multiplicative = true;
  CHECK(staircase_target(weighted) == Approx(0.75).margin(1e-12));
}

TEST_CASE("long runs settle where the observer is correct as often as the rule says") {
  const double threshold = 200, width = 40;
  const auto level_of = [&](const StaircaseRule& rule) {
    const double p = staircase_target(rule);
    return threshold + width * std::log(p / (1 - p));
  };
  for (const StaircaseRule& rule :
       {rule_of(400, 1, 2, 4, 4), rule_of(400, 1, 3, 4, 4), rule_of(400, 1, 1, 6, 2), rule_of(400, 2, 3, 4, 4)}) {
    CAPTURE(rule.up, rule.down, rule.step_up);
    // Small steps: the mean level of a stationary run is within a few units of the balance point.
    CHECK(settled_level(rule, threshold, width, 60000, 2000) == Approx(level_of(rule)).margin(4));
  }
  StaircaseRule multiplying = rule_of(400, 1, 2, 1.03, 1.03);
  multiplying.multiplicative = true;
  CHECK(settled_level(multiplying, threshold, width, 60000, 2000) == Approx(level_of(multiplying)).margin(5));
}

TEST_CASE("rules that cannot run say why") {
  CHECK(problem_of(rule_of(1, 1, 2, 1, 1)).empty());
  CHECK_FALSE(problem_of(rule_of(1, 0, 2, 1, 1)).empty());
  CHECK_FALSE(problem_of(rule_of(1, 1, 0, 1, 1)).empty());
  CHECK_FALSE(problem_of(rule_of(1, 1, 2, 0, 1)).empty());
  CHECK_FALSE(problem_of(rule_of(1, 1, 2, 1, -1)).empty());
  CHECK_FALSE(problem_of(rule_of(1, 1, 2, 1, NAN)).empty());
  StaircaseRule multiplying = rule_of(1, 1, 2, 1, 2);
  multiplying.multiplicative = true;
  CHECK_FALSE(problem_of(multiplying).empty());
  multiplying.step_up = 1.5;
  CHECK(problem_of(multiplying).empty());
  multiplying.start = 0;
  CHECK_FALSE(problem_of(multiplying).empty());
  StaircaseRule clamped = rule_of(5, 1, 2, 1, 1);
  clamped.clamp = std::array<double, 2>{6, 9};
  CHECK_FALSE(problem_of(clamped).empty());
  clamped.clamp = std::array<double, 2>{9, 1};
  CHECK_FALSE(problem_of(clamped).empty());
  StaircaseRule halving = rule_of(5, 1, 2, 1, 1);
  halving.halve_after = {0};
  CHECK_FALSE(problem_of(halving).empty());
}

TEST_CASE("whatever the answers, levels stay in the clamp and replaying gives the same") {
  CHECK(rc::check("clamp and replay", [] {
    StaircaseRule rule = rule_of(*rc::gen::inRange(50, 200), *rc::gen::inRange(1, 4), *rc::gen::inRange(1, 4),
                                 *rc::gen::inRange(1, 60), *rc::gen::inRange(1, 60));
    rule.clamp = std::array<double, 2>{50, 200};
    rule.halve_after = {2, 3};
    const auto answers = *rc::gen::container<std::vector<bool>>(rc::gen::arbitrary<bool>());
    Staircase first(rule);
    for (const bool correct : answers) {
      first.answer(correct);
      RC_ASSERT(first.level() >= 50 && first.level() <= 200);
    }
    Staircase second(rule);
    for (const bool correct : answers) second.answer(correct);
    RC_ASSERT(first.level() == second.level());
    RC_ASSERT(first.reversals() == second.reversals());
    RC_ASSERT(static_cast<int>(first.reversals().size()) < std::max(1, first.steps()));
  }));
}

TEST_CASE("accelerated steps shrink with the reversals, by hand") {
  StaircaseRule rule = rule_of(400, 1, 1, 180, 60);
  rule.accelerated = true;
  CHECK(problem_of(rule).empty());
  // Divided by 1, 2, then 2 + m: 400 - 60; - 30; wrong (m = 1): + 60; wrong: + 60; correct (m = 2): - 15; wrong (3): + 36
  const Levels found = levels_of(rule, "110010");
  CHECK(found.levels == std::vector<double>{400, 340, 310, 370, 430, 415});
  CHECK(found.next == 451);
  CHECK(found.reversals == std::vector<double>{310, 430, 415});
  // The second answer is divided by 2, whether or not it reverses.
  CHECK(levels_of(rule, "10").next == 430);
  rule.clamp = std::array<double, 2>{350, 420};
  CHECK(levels_of(rule, "1100").levels == std::vector<double>{400, 350, 350, 410});
}

TEST_CASE("accelerated steps that multiply shrink on their logarithm") {
  StaircaseRule rule = rule_of(100, 1, 1, 64, 16);
  rule.multiplicative = rule.accelerated = true;
  const Levels found = levels_of(rule, "101");
  CHECK(found.levels[1] == 100.0 / 16);
  CHECK(found.levels[2] == Approx(100.0 / 16 * 8).epsilon(1e-14));  // the square root of 64
  CHECK(found.next == Approx(100.0 / 16 * 8 / 2).epsilon(1e-14));   // m = 2: the fourth root of 16
}

TEST_CASE("accelerated steps go to the target of the weights and stay there") {
  StaircaseRule rule = rule_of(600, 1, 1, 540, 60);
  rule.accelerated = true;
  CHECK(staircase_target(rule) == Approx(0.9).epsilon(1e-12));
  const double target = 300 + 40 * std::log(9.0);  // of the logistic: ln(p / (1 - p))
  double squares = 0;
  for (std::uint64_t run = 1; run <= 200; ++run) {
    RandomStream stream(31, run, "observer");
    Staircase track(rule);
    for (int i = 0; i < 400; ++i) track.answer(stream.uniform() < 1 / (1 + std::exp(-(track.level() - 300) / 40)));
    squares += (track.level() - target) * (track.level() - target) / 200;
  }
  CAPTURE(std::sqrt(squares));
  CHECK(std::sqrt(squares) < 15);  // of a fixed step of 60 down and 540 up it would be far more
}

TEST_CASE("accelerated steps go with one up, one down and no halving") {
  StaircaseRule rule = rule_of(400, 1, 2, 50, 50);
  rule.accelerated = true;
  CHECK_FALSE(problem_of(rule).empty());
  rule.down = 1;
  CHECK(problem_of(rule).empty());
  rule.halve_after = {2};
  CHECK_FALSE(problem_of(rule).empty());
}
