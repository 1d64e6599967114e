#include "devices/mckibben/mckibben_device.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "devices/loop/governor.h"
#include "protocols/random_stream.h"

namespace jnd {

double Encoder::read_rad(double angle_rad) const noexcept {
  if (!(pulses_per_turn > 0)) return angle_rad;
  const double pulse = 2 * std::numbers::pi / pulses_per_turn;
  return zero_rad + pulse * std::nearbyint((angle_rad - zero_rad) / pulse);
}

double BeamForceSensor::noise_n(std::int64_t time_ns) const noexcept {
  if (!(noise_sd_n > 0)) return 0;
  return noise_sd_n * RandomStream(seed, 0, "mckibben/force sensor", static_cast<std::uint64_t>(time_ns)).normal();
}

double BeamForceSensor::read_n(double force_n, double noise_n) const noexcept {
  const double limited = std::clamp(force_n + noise_n, -capacity_n, capacity_n);
  return resolution_n > 0 ? resolution_n * std::nearbyint(limited / resolution_n) : limited;
}

namespace {
// More steps than this after the last read and the muscle has long vented: it need not be computed.
constexpr std::int64_t kMostSteps = 10'000;
}  // namespace

MckibbenOptions mckibben_options(const DeviceSpec& spec, std::uint64_t seed) {
  MckibbenOptions options;
  options.parameters = spec.finger;
  options.gains = spec.gains;
  options.tendon = spec.tendon;
  options.max_force_n = limit_in_force(spec.max_force_n, hard_limits(DeviceModel::mckibben).force_n);
  options.encoder.pulses_per_turn = spec.sensors.encoder_pulses;
  options.force_sensor.noise_sd_n = spec.sensors.force_noise_sd_n;
  options.force_sensor.resolution_n = spec.sensors.force_resolution_n;
  options.force_sensor.seed = seed;
  return options;
}

MckibbenDevice::MckibbenDevice(const MckibbenOptions& options, const FingerFlexion& flexion)
    : model_(options.parameters, options.tendon, options.gains),
      max_force_n_(options.max_force_n),
      encoder_(options.encoder),
      force_sensor_(options.force_sensor),
      flexion_(flexion),
      state_(model_.vented()) {
  encoder_.zero_rad = model_.linkage().usable().min_rad;
  from_ = to_ = pose_ = *model_.pose(encoder_.zero_rad);
}

// The encoder's last position may lie beyond the stop, where the linkage cannot be.
double MckibbenDevice::joint_angle_rad() const noexcept {
  return std::min(encoder_.read_rad(pose_.alpha1_rad), model_.linkage().usable().max_rad);
}

bool MckibbenDevice::is_regulating() const noexcept {
  return engaged_ && time_ns_ - written_ns_ <= kMaxAge_ns;
}

// The pose at a time, with the linkage's stops. False, and the pose untouched, where the angle is not a number.
bool MckibbenDevice::turn_to(std::int64_t time_ns, MckibbenPose& pose) noexcept {
  const AngleRange& usable = model_.linkage().usable();
  const double angle = flexion_.angle_rad(time_ns);
  if (!std::isfinite(angle)) return false;
  const std::optional<MckibbenPose> at = model_.pose(std::clamp(angle, usable.min_rad, usable.max_rad));
  if (at) pose = *at;
  return at.has_value();
}

DeviceStatus MckibbenDevice::engage(std::int64_t now_ns) noexcept {
  neutral();
  lost_ = !turn_to(now_ns, pose_);
  from_ = to_ = pose_;
  substep_ = kStepsPerMs;
  time_ns_ = written_ns_ = now_ns;
  if (lost_) {
    state_ = model_.vented();
    return DeviceStatus::lost;
  }
  state_ = model_.steady_state(pose_, 0);
  volts_ = model_.volts(state_, pose_, 0);
  engaged_ = true;
  return DeviceStatus::ok;
}

void MckibbenDevice::neutral() noexcept {
  engaged_ = false;
  reference_n_ = volts_ = 0;
  state_.controller = ControllerState{};
}

void MckibbenDevice::begin_millisecond() noexcept {
  from_ = to_;
  substep_ = 0;
  if (!turn_to(time_ns_ + kStepsPerMs * kStep_ns, to_)) {
    lost_ = true;
    neutral();
  }
  const double force = true_force_n();
  sensor_error_n_ = force_sensor_.read_n(force, force_sensor_.noise_n(time_ns_)) - force;
}

void MckibbenDevice::advance_to(std::int64_t now_ns) noexcept {
  if (now_ns - time_ns_ > kMostSteps * kStep_ns) {
    state_ = model_.vented();
    reference_n_ = volts_ = 0;
    time_ns_ = now_ns;
    substep_ = kStepsPerMs;
    if (!turn_to(now_ns, pose_)) {
      lost_ = true;
      neutral();
    }
    from_ = to_ = pose_;
    return;
  }
  while (time_ns_ + kStep_ns <= now_ns) {
    if (substep_ == kStepsPerMs) begin_millisecond();
    const MckibbenPose middle = between(from_, to_, (substep_ + 0.5) / kStepsPerMs);
    if (is_regulating()) {
      model_.regulate(state_, middle, reference_n_ - sensor_error_n_);
    } else {  // the device's own watchdog: without commands it lets go
      state_.controller = ControllerState{};
      reference_n_ = 0;
      model_.step(state_, middle, 0);
    }
    ++substep_;
    time_ns_ += kStep_ns;
    pose_ = between(from_, to_, static_cast<double>(substep_) / kStepsPerMs);
  }
  volts_ = is_regulating() ? model_.volts(state_, pose_, reference_n_ - sensor_error_n_) : 0;
}

DeviceStatus MckibbenDevice::read(std::int64_t now_ns, DeviceReading& reading) noexcept {
  advance_to(now_ns);
  reading = DeviceReading{};
  reading.time_ns = time_ns_;
  reading.force_n = force_sensor_.read_n(true_force_n(), force_sensor_.noise_n(time_ns_));
  reading.travel = joint_angle_rad();
  return lost_ ? DeviceStatus::lost : DeviceStatus::ok;
}

DeviceStatus MckibbenDevice::write(const DeviceCommand& command, std::int64_t now_ns) noexcept {
  if (lost_) return DeviceStatus::lost;
  if (!engaged_) return DeviceStatus::ok;
  reference_n_ = command.force_n > 0 && std::isfinite(command.force_n) ? std::min(command.force_n, max_force_n_) : 0;
  written_ns_ = now_ns;
  return DeviceStatus::ok;
}

}  // namespace jnd
