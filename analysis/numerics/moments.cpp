#include "analysis/numerics/moments.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "analysis/numerics/special_values.h"

namespace jnd {

Moments moments(std::span<const double> values) noexcept {
  Moments result;
  result.n = static_cast<int>(values.size());
  result.mean = result.sd = kNaN;
  if (values.empty()) return result;
  const auto n = static_cast<double>(values.size());
  const double origin = values.front();
  double sum = 0;
  for (const double value : values) sum += value - origin;
  const double shift = sum / n;  // of the mean from the origin
  result.mean = origin + shift;
  if (values.size() < 2) return result;
  double largest = 0;
  for (const double value : values) largest = std::max(largest, std::abs(value - origin - shift));
  // A power of two near 1/largest: multiplying by it rounds nothing.
  const double unit = largest > 0 ? std::ldexp(1.0, -std::clamp(std::ilogb(largest), -1000, 1000)) : 1.0;
  double squares = 0, rest = 0;
  for (const double value : values) {
    const double deviation = (value - origin - shift) * unit;
    squares += deviation * deviation;
    rest += deviation;
  }
  result.sd = std::sqrt(std::max(0.0, squares - rest * rest / n) / (n - 1)) / unit;
  return result;
}

double median_of(std::span<const double> values) {
  if (values.empty()) return kNaN;
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  const std::size_t upper = sorted.size() / 2;
  if (sorted.size() % 2 == 1) return sorted[upper];
  return sorted[upper - 1] + 0.5 * (sorted[upper] - sorted[upper - 1]);
}

double largest_magnitude(std::span<const double> values) noexcept {
  double largest = 0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  return largest;
}

bool only_rounding(double standard_error, double largest_magnitude) noexcept {
  return !(standard_error > 10 * std::numeric_limits<double>::epsilon() * largest_magnitude);
}

}  // namespace jnd
