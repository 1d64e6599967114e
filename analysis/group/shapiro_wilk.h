// Shapiro-Wilk test of normality.
//
// Source: Royston 1995, Algorithm AS R94, Applied Statistics 44(4), 547-551, for n = 3..5000; at n = 3 the exact
// p = 6/pi (asin sqrt(W) - pi/3), computed from the gaps between the values so that it keeps its digits near 0.
// Accuracy: W 1e-12 and p 1e-10 of R 4.2.2's; beyond n = 3 that p is itself Royston's approximation.
// Tests: R 4.2.2 (shapiro.test), n = 3..54; the exact p at n = 3 in closed form.
#pragma once

#include <span>

#include "analysis/numerics/statistic_status.h"

namespace jnd {

struct ShapiroWilk {
  int n = 0;
  double w = 0;  // 0..1; 1 for a perfect normal plot
  double p = 0;  // small: not normal
  StatisticStatus status =
      StatisticStatus::ok;  // else too_few (n < 3), too_many (n > 5000), no_variance; then w and p are NaN
};
// values: finite, in any order. Shifting and scaling them by a positive number changes nothing.
ShapiroWilk shapiro_wilk(std::span<const double> values);

}  // namespace jnd
