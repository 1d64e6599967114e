#include "analysis/group/group.h"

#include <cmath>

#include <boost/math/distributions/students_t.hpp>

#include "analysis/numerics/special_values.h"

namespace jnd {

MeanEstimate mean_with_ci(std::span<const double> values) {
  MeanEstimate result;
  result.n = static_cast<int>(values.size());
  result.mean = result.sd = result.ci_low = result.ci_high = kNaN;
  if (values.empty()) return result;
  const auto n = static_cast<double>(values.size());
  double sum = 0;
  for (const double value : values) sum += value;
  result.mean = sum / n;
  if (values.size() < 2) return result;
  double squares = 0;
  for (const double value : values) squares += (value - result.mean) * (value - result.mean);
  result.sd = std::sqrt(squares / (n - 1));
  const double t = boost::math::quantile(boost::math::students_t(n - 1), 0.975);
  const double half_width = t * result.sd / std::sqrt(n);
  result.ci_low = result.mean - half_width;
  result.ci_high = result.mean + half_width;
  return result;
}

}  // namespace jnd
