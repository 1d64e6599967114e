#include "analysis/numerics/sample_quantile.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/numerics/special_values.h"

namespace jnd {

SampleQuantiles::SampleQuantiles(std::vector<double> values) : values_(std::move(values)) {
  std::sort(values_.begin(), values_.end());
}

double SampleQuantiles::at(double share) const noexcept {
  if (values_.empty()) return kNaN;
  const auto size = static_cast<double>(values_.size());
  const double place = std::clamp(std::ceil(share * size) - 1, 0.0, size - 1);
  return values_[static_cast<std::size_t>(place)];
}

double SampleQuantiles::standard_error(double share) const noexcept {
  if (values_.empty()) return kNaN;
  const double step = std::sqrt(share * (1 - share) / static_cast<double>(values_.size()));
  const double low = at(share - step), high = at(share + step);
  return std::isfinite(low) && std::isfinite(high) ? (high - low) / 2 : kNaN;
}

}  // namespace jnd
