#include "devices/governor.h"

#include <algorithm>
#include <cmath>

namespace jnd {

namespace {

// A force counts as reduced beyond rounding only: the shares of saturated time are data.
constexpr double kRounding = 1e-12;
// Slack of the stroke's ends, m: a platform that rests on its stop is inside.
constexpr double kStrokeSlack_m = 1e-6;

bool all_finite(const GovernorInput& input) noexcept {
  const DeviceCommand& asked = input.asked;
  // One sum: it is finite only if all its parts are (opposite infinities make a NaN).
  return std::isfinite(asked.force_n + asked.normal.x() + asked.normal.y() + asked.normal.z() + asked.roll_rad +
                       asked.pitch_rad + asked.vibration_g + asked.vibration_hz + input.platform_z_m);
}

}  // namespace

double rise_limited_n(double asked, double previous, std::int64_t elapsed_ns) noexcept {
  const double elapsed_s = 1e-9 * static_cast<double>(std::clamp(elapsed_ns, std::int64_t{0}, kLongestRise_ns));
  return std::min(asked, previous + kMaxForceRise_n_per_s * elapsed_s);
}

double soft_start_gain(std::int64_t since_activation_ns) noexcept {
  if (since_activation_ns >= kSoftStart_ns) return 1;
  if (since_activation_ns <= 0) return 0;
  return static_cast<double>(since_activation_ns) / static_cast<double>(kSoftStart_ns);
}

void Governor::configure(const DeviceSpec& spec) noexcept {
  max_force_n_ = spec.max_force_n;
  max_roll_rad_ = spec.max_roll_rad;
  max_pitch_rad_ = spec.max_pitch_rad;
  lowest_z_m_ = spec.rest_z_m - spec.stroke_m / 2 - kStrokeSlack_m;
  highest_z_m_ = spec.rest_z_m + spec.stroke_m / 2 + kStrokeSlack_m;
  min_vibration_g_ = spec.min_vibration_g;
  max_vibration_g_ = spec.max_vibration_g;
  min_vibration_hz_ = spec.min_vibration_hz;
  max_vibration_hz_ = spec.max_vibration_hz;
  fault_ = Fault::none;
  state_ = State::inactive;
}

bool Governor::activate(std::int64_t now_ns) noexcept {
  if (state_ == State::inactive) {
    state_ = State::active;
    activated_ns_ = last_call_ns_ = now_ns;
    previous_force_n_ = 0;
    vibrating_ = false;
  }
  return state_ == State::active;
}

void Governor::deactivate() noexcept {
  if (state_ == State::active) state_ = State::inactive;
}

void Governor::trip(Fault fault) noexcept {
  if (state_ == State::unconfigured) return;
  if (state_ != State::faulted) fault_ = fault;  // the first cause is kept
  state_ = State::faulted;
}

void Governor::reset() noexcept {
  if (state_ != State::faulted) return;
  fault_ = Fault::none;
  state_ = State::inactive;
}

GovernorOutput Governor::zero(unsigned limits) const noexcept {
  GovernorOutput out;
  out.limits = limits;
  out.fault = fault_;
  return out;
}

double Governor::govern_vibration(const DeviceCommand& asked, std::int64_t now_ns, unsigned& limits) noexcept {
  if (asked.vibration_g <= 0) {
    vibrating_ = false;
    return 0;
  }
  if (!vibrating_) {
    vibrating_ = true;
    burst_start_ns_ = now_ns;
  }
  if (now_ns - burst_start_ns_ >= kMaxBurst_ns) {
    limits |= limit::kBurst;
    return 0;
  }
  const double given = std::clamp(asked.vibration_g, min_vibration_g_, max_vibration_g_);
  if (std::abs(given - asked.vibration_g) > kRounding) limits |= limit::kVibration;
  return given;
}

GovernorOutput Governor::govern(const GovernorInput& input, std::int64_t now_ns) noexcept {
  if (state_ != State::active) {
    GovernorOutput out = zero(limit::kNotActive);
    out.force_reduced = input.asked.force_n > kRounding;
    return out;
  }
  const std::int64_t elapsed_ns = now_ns - last_call_ns_;
  last_call_ns_ = now_ns;
  const std::int64_t age_ns = now_ns - input.pose_time_ns;
  if (!all_finite(input)) {
    trip(Fault::non_finite);
  } else if (elapsed_ns > kMaxAge_ns || elapsed_ns < 0 || age_ns > kMaxAge_ns || age_ns < -kMaxAge_ns) {
    // A late command is as bad as a late pose: the force in effect rested on an old one.
    trip(Fault::stale_pose);
  }
  if (state_ != State::active) {
    GovernorOutput out = zero(limit::kNotActive);
    out.force_reduced = input.asked.force_n > kRounding;
    return out;
  }

  GovernorOutput out;
  const DeviceCommand& asked = input.asked;
  out.given = asked;
  double force = asked.force_n;
  if (force < 0) {
    force = 0;
    out.limits |= limit::kPull;
  }
  if (force > max_force_n_) {
    force = max_force_n_;
    out.limits |= limit::kForceCap;
  }
  const double gain = soft_start_gain(now_ns - activated_ns_);
  out.soft_start = gain < 1;
  if (out.soft_start && force > 0) {
    force *= gain;
    out.limits |= limit::kSoftStart;
  }
  // The direction is a unit vector that pushes the finger; anything else is a mistake of the host's and gets no force.
  const bool pushes = asked.normal.z() > 0 && std::abs(asked.normal.squaredNorm() - 1) < 1e-6;
  const bool in_stroke = input.platform_z_m >= lowest_z_m_ && input.platform_z_m <= highest_z_m_;
  if (force > 0 && !(pushes && in_stroke)) {
    force = 0;
    out.limits |= limit::kWorkspace;
  }
  const double limited = rise_limited_n(force, previous_force_n_, elapsed_ns);
  if (limited < force) {
    force = limited;
    out.limits |= limit::kForceRise;
  }
  out.given.roll_rad = std::clamp(asked.roll_rad, -max_roll_rad_, max_roll_rad_);
  out.given.pitch_rad = std::clamp(asked.pitch_rad, -max_pitch_rad_, max_pitch_rad_);
  if (out.given.roll_rad != asked.roll_rad || out.given.pitch_rad != asked.pitch_rad) out.limits |= limit::kWorkspace;

  out.given.force_n = force;
  out.force_reduced = asked.force_n - force > kRounding;
  previous_force_n_ = force;

  out.given.vibration_g = govern_vibration(asked, now_ns, out.limits);
  out.given.vibration_hz = 0;
  if (out.given.vibration_g > 0) {
    out.given.vibration_hz = std::clamp(asked.vibration_hz, min_vibration_hz_, max_vibration_hz_);
    if (out.given.vibration_hz != asked.vibration_hz) out.limits |= limit::kVibration;
  }
  return out;
}

}  // namespace jnd
