#include "analysis/group/group.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <boost/math/distributions/students_t.hpp>

#include "analysis/numerics/moments.h"
#include "analysis/numerics/special_values.h"
#include "analysis/thresholds/jnd_series.h"

namespace jnd {

namespace {

// Of JNDs with 0 for those at the ceiling and +inf for those without sensitivity. Of two values in the middle that are
// not both JNDs the one that is none decides: half of its way to the other would be the JND of no participant.
void set_median(JndGroup& group, std::vector<double> values) {
  group.median_n = static_cast<int>(values.size());
  group.median_jnd = kNaN;
  if (values.empty()) return;
  std::sort(values.begin(), values.end());
  const double upper = values[values.size() / 2], lower = values[(values.size() - 1) / 2];
  if (std::isinf(upper)) {
    group.median_status = JndStatus::no_sensitivity;
    group.median_jnd = upper;
  } else if (lower == 0) {
    group.median_status = JndStatus::ceiling;
  } else {
    group.median_status = JndStatus::ok;
    group.median_jnd = median_of(values);
  }
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
        for_median.push_back(kInf);
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
  set_median(group, std::move(for_median));
  group.slope_n = static_cast<int>(slopes.size());
  const double mean_slope = mean_with_ci(slopes).mean;
  group.inverse_mean_slope = mean_slope > kLeastSlope ? 1.0 / mean_slope : kNaN;
  return group;
}

}  // namespace jnd
