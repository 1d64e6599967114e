// Which two conditions differ? Paired t, and two tests that ignore the pairing because the literature uses them.
//
// Source: Student 1908; Games and Howell 1976, Journal of Educational Statistics 1, 113-125; Tukey 1953.
// Accuracy: t 1e-12 relative, p 1e-12; p of the studentised range as studentised_range.h.
// Tests: R 4.2.2 (t.test, ptukey), rstatix (games_howell_test).
#pragma once

#include <span>

#include "analysis/numerics/statistic_status.h"

namespace jnd {

struct PairedT {
  int n = 0;
  double mean_difference = 0;      // of x - y, in the unit of the values
  double t = 0, df = 0, p = 0;     // two-sided
  double ci_low = 0, ci_high = 0;  // 95 % of the mean difference
  double dz = 0;                   // mean difference / SD of the differences
  double d_av = 0;                 // mean difference / root mean square of the two SDs
  // else too_few (n < 2), no_variance (SE below 10 ulp of the values, as R): mean_difference stands, the rest is NaN
  StatisticStatus status = StatisticStatus::ok;
};
PairedT paired_t(std::span<const double> x, std::span<const double> y);  // of equal size
// The same for many pairs of one n: t_quantile is the t of n - 1 degrees of freedom that 5 % exceed in size.
PairedT paired_t(std::span<const double> x, std::span<const double> y, double t_quantile);

// Ignores pairing: treats the conditions as separate groups of participants, with their own variances (Welch).
struct GamesHowell {
  double q = 0;  // |difference| / (SE / sqrt 2)
  double df = 0;
  double p = 0;
  double se = 0;                                 // sqrt(s1^2/n1 + s2^2/n2)
  StatisticStatus status = StatisticStatus::ok;  // as PairedT
};
// groups: how many conditions are compared with one another, 2..1000.
GamesHowell games_howell(std::span<const double> x, std::span<const double> y, int groups);
// Half the width of the 95 % simultaneous interval of the difference. NaN where the test is undefined.
double games_howell_half_width(const GamesHowell& test, int groups);

// Ignores pairing in its name only: the error term is the repeated-measures one, but sphericity is assumed.
struct Tukey {
  double q = 0;  // |difference| / sqrt(MS error / n)
  double p = 0;
  StatisticStatus status = StatisticStatus::ok;  // else no_variance, too_few
};
// mean_square_error and df: of the repeated-measures analysis. n participants, groups conditions.
Tukey tukey(double mean_difference, double mean_square_error, double n, double df, int groups);

}  // namespace jnd
