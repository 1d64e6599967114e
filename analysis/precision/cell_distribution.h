// What can come out of one cell (a participant, a condition, a series) when the true threshold is known: every d' that
// its counts can give, with its probability.
//
// The model is the one that the least-squares JND assumes (Chinello 2017, section 5.1.3): yes-no, d' = difference /
// JND.
#pragma once

#include <cstdint>
#include <vector>

#include "analysis/detection/counts.h"

namespace jnd {

// How many of a cell's n trials have equal stimuli. random: each trial with probability 1/2, so that n_same is
// Binomial(n, 1/2), as in the published design. balanced: n/2, rounded down.
enum class ClassSizes { random, balanced };

// Where a participant puts the criterion, on the axis of the stiffness difference.
struct CriterionRule {
  // half_of_difference: midway between 0 and the series' difference, so that c = 0 (unbiased) in each series.
  // common: at one value for all series.
  enum class Kind { half_of_difference, common } kind = Kind::half_of_difference;
  double common = 0;  // of Kind::common, in the differences' unit
};

// A design by its numbers: what every participant goes through in every condition.
struct CountsDesign {
  std::vector<double> differences;  // of the series, > 0, in the JND's unit (N/m or N/rad)
  int trials = 12;                  // of a cell, >= 1
  ClassSizes class_sizes = ClassSizes::random;
  Correction correction = Correction::loglinear;
  CriterionRule criterion{};
};

// One cell: what its answers are drawn from.
struct CellProbabilities {
  double hit = 0.5, false_alarm = 0.5;  // probabilities of "different", 0..1
  int trials = 12;
  ClassSizes class_sizes = ClassSizes::random;
  Correction correction = Correction::loglinear;
};
// H = Phi((difference - criterion) / JND), F = Phi(-criterion / JND). jnd > 0.
CellProbabilities cell_probabilities(const CountsDesign& design, double difference, double jnd);

// Probabilities of what makes a cell's d' doubtful: exact sums for any number of trials up to some thousands.
struct CellRisks {
  double missing = 0;       // a class without trials: no d' at all
  double extreme = 0;       // a raw rate of 0 or 1 in one class at least; `missing` counts as such
  double not_positive = 0;  // d' <= 0 after the correction, also where all answers were the same
};
CellRisks cell_risks(const CellProbabilities& cell);

// One value of the corrected d'. variance: its estimate from the same counts, Gourevitch and Galanter 1967
// (Psychometrika 32:25): H(1-H)/(n_diff phi(zH)^2) + F(1-F)/(n_same phi(zF)^2), corrected rates, raw n.
struct CellState {
  double dprime = 0;
  double variance = 0;
  double probability = 0;
  bool informative = true;  // false: all answers "same", or all "different"
};

// All probabilities together are 1. `undefined` and the infinities occur under Correction::none only.
struct CellDistribution {
  std::vector<CellState> states;  // finite d', ascending; equal ones are one state
  double missing = 0;             // a class without trials
  double plus_infinity = 0, minus_infinity = 0;
  double undefined = 0;  // inf - inf
};
CellDistribution cell_distribution(const CellProbabilities& cell);
// How many different counts a cell can give: (n/2 + 1)^2 for balanced classes, (n+1)(n+2)(n+3)/6 for random ones (455
// for 12 trials). The distribution takes time and memory in proportion.
std::int64_t counts_of_cell(int trials, ClassSizes class_sizes) noexcept;

// n Var(d') for large n and classes of n/2: 2 (H(1-H)/phi(zH)^2 + F(1-F)/phi(zF)^2); inf where a rate is 0 or 1.
double asymptotic_variance(const CellProbabilities& cell) noexcept;

}  // namespace jnd
