// Quantiles of simulated values, with their standard errors.
#pragma once

#include <vector>

namespace jnd {

class SampleQuantiles {
 public:
  explicit SampleQuantiles(std::vector<double> values);  // may be infinite, never NaN

  // The smallest value that at least this share of the values do not exceed, 0 < share < 1. NaN for no values.
  double at(double share) const noexcept;
  // Half the distance of the quantiles one binomial standard error of the share to both sides. NaN where one is
  // infinite.
  double standard_error(double share) const noexcept;

 private:
  std::vector<double> values_;  // ascending
};

}  // namespace jnd
