// The mean of a few numbers with its t interval, and whether it differs from zero.
//
// Source: Student 1908. Accuracy: 1e-12 relative. Tests: R 4.2.2 (t.test), by way of the statistics that use it.
#pragma once

#include <span>

#include "analysis/numerics/statistic_status.h"

namespace jnd {

struct MeanInterval {
  int n = 0;
  double mean = 0;                               // NaN for n = 0
  double sd = 0, se = 0;                         // n - 1 in the denominator; NaN for n < 2
  double ci_low = 0, ci_high = 0;                // 95 %, Student t of n - 1 degrees of freedom; NaN for n < 2
  StatisticStatus status = StatisticStatus::ok;  // else too_few (n < 2)
};
// values: finite. One that is NaN makes mean, sd, se and interval NaN (status too_few): nothing is left out silently.
MeanInterval mean_interval(std::span<const double> values);

// Student's t of one sample against 0, two-sided.
struct MeanTest {
  double t = 0, p = 0;
  StatisticStatus status = StatisticStatus::ok;  // else too_few, no_variance (se below 10 ulp of `scale`): both NaN
};
// scale: the largest |value| of the data that the mean is of, which says what rounding is.
MeanTest mean_test(const MeanInterval& of, double scale);

}  // namespace jnd
