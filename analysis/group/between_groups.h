// Two groups of different participants: does the one lie above the other?
//
// Source: Welch 1947, Biometrika 34, 28-35 (Student's t with each group's own variance); Mann and Whitney 1947, Annals of
// Mathematical Statistics 18, 50-60, with the conventions of R 4.2.2's wilcox.test(x, y): exact where both groups have
// fewer than 50 values and none ties; else the normal approximation with the corrections for continuity (0.5) and ties.
// Ties are those of the decimals that were read (decimal_order.h).
// Accuracy: 1e-12 relative. Tests: R's documented data set `sleep`, direct enumeration, a second computation.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "analysis/group/mixed_anova.h"
#include "analysis/group/shapiro_wilk.h"
#include "analysis/numerics/statistic_status.h"
#include "analysis/scaling/mean_interval.h"

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

// Everything that a paper reports about groups of participants: descriptives of each group and condition, the analysis
// of variance, and every pair of groups under each condition.
//
// Source: mixed_anova.h and above; Holm 1979 (p_adjust.h) over all pairs and conditions. Accuracy and tests:
// theirs.
struct GroupCell {
  std::size_t group = 0, condition = 0;
  MeanInterval mean;
  double median = 0;  // NaN without a value
  ShapiroWilk shapiro;
};

// Two groups under one condition. p_holm: over all pairs and conditions of the table; NaN where p is.
struct GroupPair {
  std::size_t a = 0, b = 0, condition = 0;
  WelchT welch;
  double welch_p_holm = 0;
  MannWhitney ranks;
  double ranks_p_holm = 0;
};

struct GroupComparison {
  std::vector<GroupCell> cells;  // by condition, then group
  MixedAnova anova;              // with one condition: one-way between groups
  std::vector<GroupPair> pairs;  // by condition, then (0,1), (0,2), ..., (1,2), ...
};

// table: finite; a group may be empty. Every part has a status of its own; what is undefined is NaN.
GroupComparison compare_groups(const GroupedTable& table);

}  // namespace jnd
