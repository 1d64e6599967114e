// How often the intervals and tests of one cell are right: exact, by all (hits, false alarms) with their probabilities.
//
// Yes-no observer with criterion c: H = Phi(d'/2 - c), F = Phi(-d'/2 - c), and the same number of trials in both
// classes.
#pragma once

#include <vector>

#include "analysis/detection/counts.h"

namespace jnd {

// Of the yes-no profile-likelihood interval (dprime_intervals.h), nominally 0.95.
class ProfileCoverage {
 public:
  // Computes the intervals of all (n + 1)^2 outcomes once. trials_a_class >= 1.
  explicit ProfileCoverage(int trials_a_class);
  // P(the interval holds the true d').
  double at(double dprime, double criterion) const;

 private:
  struct Interval {
    double low, high;
  };
  int n_;
  std::vector<Interval> intervals_;  // [hits (n + 1) + false alarms]
};

// P(p <= level) where d' is 0: of the two-sided likelihood-ratio test of the yes-no model, and of the one-sided test of
// the differencing model. The latter's parameter is then at its boundary, and its deviance, half 0 and half
// chi-square(1), gives p = 0.5 in about every other outcome. Outcomes of one and the same answer have no p and reject
// nothing.
struct TestSizes {
  double yes_no_05, yes_no_01;
  double differencing_05, differencing_01;
};
TestSizes test_sizes(int trials_a_class, double criterion);

}  // namespace jnd
