// The mean of a group, and how well it is known.
#pragma once

#include <algorithm>
#include <span>

namespace jnd {

struct MeanEstimate {
  int n = 0;                       // used
  double mean = 0;                 // NaN for n = 0
  double sd = 0;                   // n - 1 in the denominator; NaN for n < 2
  double ci_low = 0, ci_high = 0;  // 95 %, Student t; NaN for n < 2
};
MeanEstimate mean_with_ci(std::span<const double> values);
// Of values between 0 and 1: the ends of their mean's interval stay there too. NaN stays NaN.
inline void keep_within_0_and_1(double& low, double& high) noexcept {
  low = std::max(low, 0.0);
  high = std::min(high, 1.0);
}

}  // namespace jnd
