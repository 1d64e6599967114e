// Reference runs of the adaptive procedures, recomputed.
#include <algorithm>
#include <array>
#include <string_view>

#include "analysis/procedures/quest.h"
#include "analysis/procedures/staircase.h"
#include "analysis/selftest/selftest.h"

namespace jnd {
namespace {

// An independent implementation in numpy of Watson & Pelli (1983) on the grid -3 .. 1 by 0.01; 15 digits.
struct QuestTrial {
  double x;
  bool correct;
  double mean, mode, median, sd;  // after the answer
};
constexpr std::array<QuestTrial, 12> kQuest = {{
    {-1, true, -1.29780870768666, -1.22, -1.41, 1.03178643169503},
    {-1.2, true, -1.55617420347526, -1.4, -1.68, 0.94163472740927},
    {-1.5, false, -0.639933331755656, -1.27, -0.87, 0.741781939185287},
    {-1.3, true, -0.78989653961547, -1.33, -1.07, 0.737955150529601},
    {-1.4, false, -0.567795836180984, -1.24, -0.79, 0.703003508374739},
    {-1.25, true, -0.699752945893864, -1.28, -1.01, 0.692710662699126},
    {-1.3, true, -0.824312263674283, -1.31, -1.14, 0.665815671864371},
    {-1.35, true, -0.933335933354017, -1.33, -1.22, 0.627811703096758},
    {-1.45, false, -0.821966877921406, -1.3, -1.14, 0.657162911524633},
    {-1.3, true, -0.940511396770216, -1.32, -1.22, 0.609197953613208},
    {-1.35, true, -1.03540643090119, -1.33, -1.26, 0.55623132875072},
    {-1.4, true, -1.10759250947965, -1.35, -1.29, 0.50609097455264},
}};
constexpr double kThresholdShift = 0.00483943710518652;

// Levitt's (1971) rules worked through by an independent implementation; the same answers for both rules.
constexpr std::string_view kAnswers = "111111011010111101110011110111";  // 1 = correct

struct StaircaseRun {
  int down;
  double step;
  std::vector<int> halve_after;
  double target;
  std::vector<double> levels;
  double next;
  std::vector<double> reversals;
};
std::vector<StaircaseRun> staircase_runs() {
  return {
      {2,
       50,
       {},
       0.707106781186548,
       {400, 400, 350, 350, 300, 300, 250, 300, 300, 250, 300, 300, 350, 350, 300,
        300, 250, 300, 300, 250, 250, 300, 350, 350, 300, 300, 250, 300, 300, 250},
       250,
       {250, 300, 250, 350, 250, 300, 250, 350, 250, 300}},
      {3,
       80,
       {1, 2},
       0.7937005259841,
       {400, 400, 400, 320, 320, 320, 240, 280, 280, 280, 320, 320, 360, 360, 360,
        340, 340, 360, 360, 360, 340, 360, 380, 380, 380, 360, 360, 380, 380, 380},
       360,
       {240, 360, 340, 360, 340, 380, 360, 380}},
  };
}

// Sequences of unequal length differ in every case.
void compare(SelftestQuantity& quantity, const std::vector<double>& ours, const std::vector<double>& reference) {
  for (std::size_t i = 0; i < std::max(ours.size(), reference.size()); ++i)
    quantity.absolute(i < ours.size() ? ours[i] : HUGE_VAL, i < reference.size() ? reference[i] : -HUGE_VAL);
}

SelftestQuantity named(std::string name, double tolerance) {
  SelftestQuantity quantity;
  quantity.name = std::move(name);
  quantity.tolerance = tolerance;
  return quantity;
}

}  // namespace

std::vector<SelftestQuantity> selftest_adaptive() {
  SelftestQuantity levels = named("staircase levels and reversals", 0);
  SelftestQuantity targets = named("staircase target probability", 1e-12);
  for (const StaircaseRun& reference : staircase_runs()) {
    StaircaseRule rule;
    rule.start = 400;
    rule.up = 1;
    rule.down = reference.down;
    rule.step_up = rule.step_down = reference.step;
    rule.halve_after = reference.halve_after;
    rule.clamp = std::array<double, 2>{10, 1000};
    Staircase run(rule);
    std::vector<double> ours;
    for (const char answer : kAnswers) {
      ours.push_back(run.level());
      run.answer(answer == '1');
    }
    compare(levels, ours, reference.levels);
    compare(levels, run.reversals(), reference.reversals);
    levels.absolute(run.level(), reference.next);
    targets.absolute(staircase_target(rule), reference.target);
  }

  QuestParameters parameters;
  parameters.t_guess = -1;
  parameters.t_guess_sd = 2;
  parameters.p_threshold = 0.82;
  parameters.beta = 3.5;
  parameters.delta = 0.01;
  parameters.gamma = 0.5;
  parameters.grain = 0.01;
  parameters.range = 4;
  SelftestQuantity shift = named("QUEST threshold shift", 1e-14);
  shift.absolute(quest_threshold_shift(parameters), kThresholdShift);
  SelftestQuantity posterior = named("QUEST mean and sd", 1e-12);
  SelftestQuantity grid = named("QUEST mode and median", 1e-12);
  Quest run(parameters);
  for (const QuestTrial& trial : kQuest) {
    run.answer(trial.x, trial.correct);
    const QuestEstimate estimate = run.estimate();
    posterior.absolute(estimate.mean, trial.mean);
    posterior.absolute(estimate.sd, trial.sd);
    grid.absolute(estimate.mode, trial.mode);
    grid.absolute(estimate.median, trial.median);
  }
  return {levels, targets, shift, posterior, grid};
}

}  // namespace jnd
