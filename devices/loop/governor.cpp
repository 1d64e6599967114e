#include "devices/loop/governor.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "protocols/rigs/device_models.h"

namespace jnd {

namespace {

// A force counts as reduced beyond rounding only: the shares of saturated time are data.
constexpr double kRounding = 1e-12;
// Slack of the range's ends, m or rad: a device that rests on its stop is inside.
constexpr double kTravelSlack = 1e-6;

bool all_finite(const GovernorInput& input) noexcept {
  const DeviceCommand& asked = input.asked;
  // One sum: it is finite only if all its parts are (opposite infinities make a NaN).
  return std::isfinite(asked.force_n + asked.normal.x() + asked.normal.y() + asked.normal.z() + asked.roll_rad +
                       asked.pitch_rad + asked.vibration_g + asked.vibration_hz + asked.stiffness_n_per_m +
                       asked.penetration_m + asked.penetration_rate_m_per_s + asked.damping_n_s_per_m +
                       asked.contact_point_m.sum() + input.travel);
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
  const HardLimits hard = hard_limits(spec.model);
  max_force_n_ = limit_in_force(spec.max_force_n, hard.force_n);
  max_roll_rad_ = limit_in_force(spec.max_roll_rad, hard.roll_rad);
  max_pitch_rad_ = limit_in_force(spec.max_pitch_rad, hard.pitch_rad);
  lowest_travel_ = spec.lowest_travel - kTravelSlack;
  highest_travel_ = spec.highest_travel + kTravelSlack;
  max_vibration_g_ = limit_in_force(spec.max_vibration_g, hard.vibration_g);
  min_vibration_g_ = limit_in_force(spec.min_vibration_g, max_vibration_g_);
  max_vibration_hz_ = limit_in_force(spec.max_vibration_hz, hard.vibration_hz);
  min_vibration_hz_ = limit_in_force(spec.min_vibration_hz, max_vibration_hz_);
  fault_ = Fault::none;
  state_ = State::inactive;
}

bool Governor::activate(std::int64_t now_ns) noexcept {
  if (state_ == State::inactive) {
    state_ = State::active;
    activated_ns_ = last_call_ns_ = now_ns;
    previous_force_n_ = 0;
    vibrating_ = false;
    tallies_ = {};
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

void Governor::act(unsigned bit, double asked, double given, unsigned& limits) noexcept {
  limits |= bit;
  LimitTally& tally = tallies_[static_cast<std::size_t>(std::countr_zero(bit))];
  if (tally.ticks == 0 || std::abs(asked - given) > std::abs(tally.asked - tally.given)) {
    tally.asked = asked;
    tally.given = given;
  }
  ++tally.ticks;
}

// Nothing is given; what was asked is still told.
GovernorOutput Governor::refuse(const DeviceCommand& asked) noexcept {
  GovernorOutput out;
  out.fault = fault_;
  out.force_reduced = asked.force_n > kRounding;
  out.limits = limit::kNotActive;
  if (!(asked.force_n == 0)) act(limit::kNotActive, asked.force_n, 0, out.limits);
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
    act(limit::kBurst, asked.vibration_g, 0, limits);
    return 0;
  }
  const double given = std::clamp(asked.vibration_g, min_vibration_g_, max_vibration_g_);
  if (std::abs(given - asked.vibration_g) > kRounding) act(limit::kVibration, asked.vibration_g, given, limits);
  return given;
}

double Governor::govern_force(const GovernorInput& input, std::int64_t now_ns, std::int64_t elapsed_ns,
                              GovernorOutput& out) noexcept {
  const DeviceCommand& asked = input.asked;
  double force = asked.force_n;
  const auto reduce = [&](unsigned bit, double given) {
    act(bit, force, given, out.limits);
    force = given;
  };
  if (force < 0) reduce(limit::kPull, 0);
  if (force > max_force_n_) reduce(limit::kForceCap, max_force_n_);
  const double gain = soft_start_gain(now_ns - activated_ns_);
  out.soft_start = gain < 1;
  if (out.soft_start && force > 0) reduce(limit::kSoftStart, force * gain);
  // The direction is a unit vector that pushes the finger; anything else is a mistake of the host's and gets no force.
  const bool pushes = asked.normal.z() > 0 && std::abs(asked.normal.squaredNorm() - 1) < 1e-6;
  const bool in_range = input.travel >= lowest_travel_ && input.travel <= highest_travel_;
  if (force > 0 && !(pushes && in_range)) reduce(limit::kWorkspace, 0);
  const double limited = rise_limited_n(force, previous_force_n_, elapsed_ns);
  if (limited < force) reduce(limit::kForceRise, limited);
  return force;
}

void Governor::govern_tilt(const DeviceCommand& asked, GovernorOutput& out) noexcept {
  out.given.roll_rad = std::clamp(asked.roll_rad, -max_roll_rad_, max_roll_rad_);
  out.given.pitch_rad = std::clamp(asked.pitch_rad, -max_pitch_rad_, max_pitch_rad_);
  if (out.given.roll_rad != asked.roll_rad) act(limit::kWorkspace, asked.roll_rad, out.given.roll_rad, out.limits);
  if (out.given.pitch_rad != asked.pitch_rad) act(limit::kWorkspace, asked.pitch_rad, out.given.pitch_rad, out.limits);
}

GovernorOutput Governor::govern(const GovernorInput& input, std::int64_t now_ns) noexcept {
  const DeviceCommand& asked = input.asked;
  if (state_ != State::active) return refuse(asked);
  const std::int64_t elapsed_ns = now_ns - last_call_ns_;
  last_call_ns_ = now_ns;
  const std::int64_t age_ns = now_ns - input.pose_time_ns;
  if (!all_finite(input)) {
    trip(Fault::non_finite);
  } else if (elapsed_ns > kMaxAge_ns || elapsed_ns < 0) {
    trip(Fault::command_gap);  // the force in effect rested on a command that old
  } else if (age_ns > kMaxAge_ns || age_ns < -kMaxAge_ns) {
    trip(Fault::stale_pose);
  }
  if (state_ != State::active) return refuse(asked);

  GovernorOutput out;
  out.given = asked;
  out.given.force_n = govern_force(input, now_ns, elapsed_ns, out);
  out.force_reduced = asked.force_n - out.given.force_n > kRounding;
  previous_force_n_ = out.given.force_n;
  govern_tilt(asked, out);
  out.given.vibration_g = govern_vibration(asked, now_ns, out.limits);
  out.given.vibration_hz = 0;
  if (out.given.vibration_g > 0) {
    out.given.vibration_hz = std::clamp(asked.vibration_hz, min_vibration_hz_, max_vibration_hz_);
    if (out.given.vibration_hz != asked.vibration_hz)
      act(limit::kVibration, asked.vibration_hz, out.given.vibration_hz, out.limits);
  }
  return out;
}

}  // namespace jnd
