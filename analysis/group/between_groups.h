// Two groups of different participants: does the one lie above the other?
//
// Source: Welch 1947, Biometrika 34, 28-35 (Student's t with each group's own variance); Mann and Whitney 1947, Annals of
// Mathematical Statistics 18, 50-60, with the conventions of R 4.2.2's wilcox.test(x, y): exact where both groups have
// fewer than 50 values and none ties; else the normal approximation with the corrections for continuity (0.5) and ties.
// Ties are those of the decimals that were read (decimal_order.h).
// Accuracy: 1e-12 relative. Tests: R's documented data set `sleep`, direct enumeration, a second computation.
#pragma once

#include <span>

#include "analysis/numerics/statistic_status.h"

namespace jnd {

struct WelchT {
  int n_x = 0, n_y = 0;
  double mean_difference = 0;      // of x - y, in the unit of the values
  double t = 0, df = 0, p = 0;     // two-sided
  double ci_low = 0, ci_high = 0;  // 95 % of the mean difference
  double d = 0;                    // Cohen's: mean difference / pooled SD
  // else too_few (a group with n < 2), no_variance (SE below 10 ulp of the values, as R): all but the mean difference NaN
  StatisticStatus status = StatisticStatus::ok;
};
WelchT welch_t(std::span<const double> x, std::span<const double> y);  // finite

// Groups from this size on have no exact p, as in R.
inline constexpr int kLeastNormalMannWhitney = 50;

struct MannWhitney {
  double w = 0;              // pairs with x above y, a tie counts half: R's W
  double p = 0;              // two-sided: exact or normal
  bool exact = false;        // which of the two p is
  bool ties = false;         // in all values together
  double p_normal = 0;       // continuity and tie correction, whatever n
  double rank_biserial = 0;  // 2 W / (n_x n_y) - 1: -1..1
  // else too_few (a group is empty: all NaN), no_variance (all values are equal: p is NaN)
  StatisticStatus status = StatisticStatus::ok;
};
MannWhitney mann_whitney(std::span<const double> x, std::span<const double> y);  // finite

}  // namespace jnd
