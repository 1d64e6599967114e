// Transformed and weighted up-down staircases: n wrong answers raise the level, m correct ones lower it.
//
// Levitt (1971), "Transformed up-down methods in psychoacoustics", J. Acoust. Soc. Am. 49, 467-477; steps of unequal
// size: Kaernbach (1991), "Simple adaptive testing with the weighted up-down method", Perception & Psychophysics 49,
// 227-229; steps that shrink: Kesten (1958), "Accelerated stochastic approximation", Annals of Mathematical Statistics
// 29, 41-59, as Treutwein (1995), "Adaptive psychophysical procedures", Vision Research 35, 2503-2522, writes it. A
// staircase is a pure function of its rule and the answers: replaying them gives the same levels everywhere.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace jnd {

struct StaircaseRule {
  double start = 1;      // first level, in the unit of the levels; > 0 where steps multiply
  int up = 1;            // so many wrong answers in a row raise the level; >= 1
  int down = 2;          // so many correct answers in a row lower it; >= 1
  double step_up = 1;    // > 0: added; where steps multiply > 1: the level is multiplied by it
  double step_down = 1;  // > 0: subtracted; where steps multiply > 1: the level is divided by it
  bool multiplicative = false;
  // Reversals, counted from 1, that halve both steps, beginning with the step of that reversal itself. A step that
  // multiplies is halved on its logarithm: its square root.
  std::vector<int> halve_after{};
  // Steps are divided by n at the first two answers (n = 1, 2), then by 2 + m, where m is the number of reversals so
  // far, one at this answer included (a step that multiplies: on its logarithm). With step_up = c p and step_down =
  // c (1 - p) that is x - c/(2 + m) (answer - p), which goes to the level of p correct. 1-up-1-down only, and without
  // halve_after.
  bool accelerated = false;
  std::optional<std::array<double, 2>> clamp{};  // lowest and highest level
};

// What is wrong with a rule, in words; empty where it can be run.
std::string problem_of(const StaircaseRule& rule);

class Staircase {
 public:
  // rule: one without a problem. The first level is clamped.
  explicit Staircase(const StaircaseRule& rule);

  // The level to present next.
  double level() const noexcept { return level_; }
  // The answer to a trial at level(). Answers of the other kind, and every change of level, start the counting anew.
  void answer(bool correct);

  int answers() const noexcept { return answers_; }
  // Levels at which the direction changed: of the trial whose answer turned it. A step that the clamp swallows has a
  // direction too.
  const std::vector<double>& reversals() const noexcept { return reversals_; }
  int steps() const noexcept { return steps_; }

 private:
  double clamped(double level) const;
  double stepped(bool correct) const;

  StaircaseRule rule_;
  double level_;
  double step_up_, step_down_;  // as halved so far
  int correct_ = 0, wrong_ = 0, direction_ = 0, answers_ = 0, steps_ = 0;
  std::vector<double> reversals_;
};

// Probability of a correct answer at which the rule neither rises nor falls on average: with Q(p) the probability that
// `down` correct answers in a row come before `up` wrong ones, Q step_down = (1 - Q) step_up (logarithms of steps that
// multiply). For up = 1, Q = p^down: 0.7071 for 1-up-2-down with equal steps (Levitt, table I), step_up / (step_up +
// step_down) for 1-up-1-down (Kaernbach, equation 1).
double staircase_target(const StaircaseRule& rule);

}  // namespace jnd
