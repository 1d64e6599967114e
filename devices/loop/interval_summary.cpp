#include "devices/loop/interval_summary.h"

#include <cmath>

namespace jnd {

void IntervalSummary::begin(bool force_commanded, double path_per_penetration) noexcept {
  *this = IntervalSummary{};
  force_commanded_ = force_commanded;
  path_per_penetration_ = path_per_penetration;
}

void IntervalSummary::add(const IntervalSample& sample) noexcept {
  so_far_.peak_force_n = std::max(so_far_.peak_force_n, sample.force_n);
  so_far_.vibration_g = std::max(so_far_.vibration_g, sample.vibration_g);
  so_far_.vibration_clamped = so_far_.vibration_clamped || sample.vibration_clamped;
  if (!sample.touching) {
    touching_ = false;
    return;
  }
  const double x = sample.penetration, f = sample.force_n;
  if (!touching_) {
    touching_ = true;
    ++so_far_.contacts;
    previous_penetration_ = 0;
    previous_force_n_ = 0;
  } else {
    // Between two samples in contact; the way to the first one began at an unknown place outside.
    travel_ += std::abs(x - previous_penetration_);
    travel_s_ += sample.duration_s;
  }
  so_far_.dwell_s += sample.duration_s;
  if (sample.force_reduced) saturated_s_ += sample.duration_s;
  so_far_.deepest_penetration = std::max(so_far_.deepest_penetration, x);
  if (x > previous_penetration_)
    so_far_.work_j += (f + previous_force_n_) / 2 * (x - previous_penetration_) * path_per_penetration_;
  if (force_commanded_ && !sample.force_reduced && !sample.soft_start) {
    sum_xf_ += x * f;
    sum_xx_ += x * x;
    sum_ff_ += f * f;
    ++so_far_.fit_samples;
  }
  previous_penetration_ = x;
  previous_force_n_ = f;
}

FingerPresentation IntervalSummary::result() const {
  FingerPresentation result = so_far_;
  if (sum_xx_ > 0) {
    const double slope = sum_xf_ / sum_xx_;
    result.stiffness = slope;
    if (result.fit_samples > 1) {
      // Residuals of a line through the origin: sum (f - slope x)^2 = sum f^2 - slope sum x f.
      const double residual = std::max(sum_ff_ - slope * sum_xf_, 0.0);
      result.stiffness_se = std::sqrt(residual / (static_cast<double>(result.fit_samples - 1) * sum_xx_));
    }
  }
  if (travel_s_ > 0) result.mean_speed = travel_ / travel_s_;
  if (result.dwell_s > 0) result.saturated_share = saturated_s_ / result.dwell_s;
  return result;
}

}  // namespace jnd
