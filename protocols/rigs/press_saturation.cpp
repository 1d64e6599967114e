#include "protocols/rigs/press_saturation.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "analysis/numerics/normal.h"

namespace jnd {
namespace {

constexpr double kPressSd_m = 0.001;
constexpr double kPressSdOfJoint = 0.2;  // of the expected depth
constexpr double kHandPeriod_s = 1, kJointPeriod_s = 2;
constexpr int kDepths = 400;  // equally probable ones, in place of the distribution: the share is good to 0.1 %

bool flexes_joint(const Protocol& protocol) noexcept {
  return protocol.rig.contact_flexion_rad > 0;
}

}  // namespace

double depth_at_force_limit(double stiffness, const DeviceSpec& spec, double force_gain) noexcept {
  return spec.max_force_n / (force_gain * stiffness);
}

double expected_press_sd(const Protocol& protocol) noexcept {
  return flexes_joint(protocol) ? kPressSdOfJoint * protocol.stimulus.expected_press : kPressSd_m;
}

double expected_saturated_intervals(double stiffness, const Protocol& protocol, const DeviceSpec& spec,
                                    double force_gain) noexcept {
  const double period_s = flexes_joint(protocol) ? kJointPeriod_s : kHandPeriod_s;
  const double presses = std::max(1.0, std::floor(protocol.timeline.explore_s / period_s)) *
                         static_cast<double>(protocol.rig.fingers.size());
  const double margin = depth_at_force_limit(stiffness, spec, force_gain) - protocol.stimulus.expected_press;
  return 1 - std::pow(normal_cdf(margin / expected_press_sd(protocol)), presses);
}

double expected_saturated_share(double stiffness, const Protocol& protocol, const DeviceSpec& spec,
                                double force_gain) noexcept {
  const double limit = depth_at_force_limit(stiffness, spec, force_gain);
  double sum = 0;
  for (int i = 0; i < kDepths; ++i) {
    const double depth =
        protocol.stimulus.expected_press + expected_press_sd(protocol) * normal_quantile((i + 0.5) / kDepths);
    if (depth > limit) sum += 1 - std::asin(limit / depth) / (std::numbers::pi / 2);
  }
  return sum / kDepths;
}

}  // namespace jnd
