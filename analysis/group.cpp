#include "analysis/group.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <boost/math/distributions/students_t.hpp>

namespace jnd {

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kLeastSlope = 1e-9;  // as in jnd.cpp: smaller means are rounding zeros

// Between two infinities the median is infinite, not undefined.
double median(std::vector<double> values) {
  if (values.empty()) return kNaN;
  std::sort(values.begin(), values.end());
  const std::size_t upper = values.size() / 2;
  if (values.size() % 2 == 1 || values[upper - 1] == values[upper]) return values[upper];
  return values[upper - 1] + 0.5 * (values[upper] - values[upper - 1]);
}

}  // namespace

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

JndGroup jnd_group(std::span<const JndEstimate> estimates) {
  JndGroup group;
  group.n = static_cast<int>(estimates.size());
  std::vector<double> jnds, webers, logs, for_median, slopes;
  for (const JndEstimate& estimate : estimates) {
    switch (estimate.status) {
      case JndStatus::ok:
        jnds.push_back(estimate.jnd);
        webers.push_back(estimate.weber);
        logs.push_back(std::log(estimate.jnd));
        for_median.push_back(estimate.jnd);
        break;
      case JndStatus::no_sensitivity:
        ++group.no_sensitivity;
        for_median.push_back(std::numeric_limits<double>::infinity());
        break;
      case JndStatus::ceiling:
        ++group.ceiling;
        for_median.push_back(0);
        break;
      case JndStatus::no_information:
        ++group.no_information;
        break;
    }
    if (std::isfinite(estimate.slope) && estimate.status != JndStatus::no_information) slopes.push_back(estimate.slope);
  }
  group.mean_jnd = mean_with_ci(jnds);
  group.mean_weber = mean_with_ci(webers);
  group.mean_log_jnd = mean_with_ci(logs);
  group.median_n = static_cast<int>(for_median.size());
  group.median_jnd = median(std::move(for_median));
  group.slope_n = static_cast<int>(slopes.size());
  const double mean_slope = mean_with_ci(slopes).mean;
  group.inverse_mean_slope = mean_slope > kLeastSlope ? 1.0 / mean_slope : kNaN;
  return group;
}

}  // namespace jnd
