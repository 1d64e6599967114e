#include "devices/rrs3/rrs3_device.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "devices/loop/governor.h"
#include "devices/rrs3/rrs3_position_control.h"
#include "protocols/input/input_error.h"
#include "protocols/rigs/device_models.h"

namespace jnd {

namespace {
constexpr std::string_view kPurpose = "force_sensor";
}  // namespace

ForceSensor::ForceSensor(const ForceSensorOptions& options, std::uint64_t seed)
    : options_(options), seed_(seed), noise_(seed, 0, kPurpose) {
  if (!(options.noise_sd_n >= 0) || !std::isfinite(options.noise_sd_n))
    throw InputError(fmt::format("the force sensor's noise_sd_n is {}: give 0 or more newtons", options.noise_sd_n));
  if (!(options.resolution_n >= 0) || !std::isfinite(options.resolution_n))
    throw InputError(fmt::format("the force sensor's resolution_n is {}: give 0 (continuous) or more newtons",
                                 options.resolution_n));
  if (!(options.min_n < options.max_n))
    throw InputError(fmt::format("the force sensor's range {} to {} N is empty: give min_n below max_n", options.min_n,
                                 options.max_n));
}

void ForceSensor::begin(std::uint64_t part) noexcept {
  noise_ = RandomStream(seed_, 0, kPurpose, part);
}

double ForceSensor::measure(double force_n) noexcept {
  double value = force_n;
  if (options_.noise_sd_n > 0) value += options_.noise_sd_n * noise_.normal();
  if (std::isnan(value)) return value;
  if (options_.resolution_n > 0) value = options_.resolution_n * std::nearbyint(value / options_.resolution_n);
  return std::clamp(value, options_.min_n, options_.max_n);
}

namespace {
// More steps than this after the last read and everything has long settled: the model starts from rest.
constexpr std::int64_t kMostStepsAtOnce = 250;
// A contact softer than this is none: at 4.7 N its surface would lie metres inside.
constexpr double kSoftest_n_per_m = 1;

bool all_finite(const DeviceCommand& command) noexcept {
  return std::isfinite(command.force_n + command.stiffness_n_per_m + command.normal.x() + command.normal.y() +
                       command.normal.z() + command.roll_rad + command.pitch_rad + command.vibration_g +
                       command.vibration_hz);
}

VibrationLimits motor_limits(const DeviceSpec& spec) noexcept {
  const HardLimits hard = hard_limits(spec.model);
  const double most_g = limit_in_force(spec.max_vibration_g, hard.vibration_g);
  const double most_hz = limit_in_force(spec.max_vibration_hz, hard.vibration_hz);
  return {.min_g = limit_in_force(spec.min_vibration_g, most_g),
          .max_g = most_g,
          .min_hz = limit_in_force(spec.min_vibration_hz, most_hz),
          .max_hz = most_hz};
}

bool pushes(const Eigen::Vector3d& normal) noexcept {
  return normal.z() > 0 && std::abs(normal.squaredNorm() - 1) < 1e-6;
}

}  // namespace

Rrs3Device::Rrs3Device(const DeviceSpec& spec, const Rrs3DeviceOptions& options)
    : platform_(spec, options.pulp_stiffness_n_per_m),
      max_force_n_(limit_in_force(spec.max_force_n, hard_limits(spec.model).force_n)),
      mode_(options.mode),
      sensor_(options.sensor, options.seed),
      motor_(motor_limits(spec)) {
  neutral();
}

DeviceStatus Rrs3Device::engage(std::int64_t now_ns) noexcept {
  neutral();
  sensor_.begin(next_part_++);
  time_ns_ = written_ns_ = now_ns;
  return DeviceStatus::ok;
}

void Rrs3Device::let_go() noexcept {
  command_ = DeviceCommand{};
  motor_.stop();
}

void Rrs3Device::neutral() noexcept {
  let_go();
  platform_.rest();
  torques_.setZero();
}

bool Rrs3Device::position_controlled() const noexcept {
  return mode_ != RenderingMode::wrench && command_.stiffness_n_per_m >= kSoftest_n_per_m && command_.force_n > 0;
}

// The force that the torques put on the platform along its normal.
double Rrs3Device::drive() noexcept {
  if (command_.force_n <= 0) {
    torques_.setZero();
    return 0;
  }
  // While the platform still turns, a force along n would press harder than |f| along the platform's own normal: the
  // finger must never get more than was commanded.
  const double share = std::min(1.0, platform_.normal().z() / command_.normal.z());
  Wrench wrench = Wrench::Zero();
  wrench.head<3>() = command_.force_n * share * command_.normal;
  torques_ = joint_torques(platform_.differential(), wrench);
  return platform_.force_of(torques_);
}

// The same in the pd modes; negative where the platform lies deeper than it should.
double Rrs3Device::drive_to_position() noexcept {
  const double stiffness = command_.stiffness_n_per_m;
  const double displacement = command_.force_n / stiffness;
  torques_.setZero();
  if (mode_ == RenderingMode::pd) {
    const std::optional<Rrs3Pose> desired = platform_.kinematics().pose(
        pressed_by(platform_.kinematics().geometry(), displacement, command_.roll_rad, command_.pitch_rad));
    if (!desired) return 0;
    torques_ = joint_torques(platform_.differential(),
                             position_wrench(platform_.configuration(), *desired, stiffness, command_.force_n));
    return platform_.force_of(torques_);
  }
  const std::optional<Eigen::Vector3d> joints =
      reachable_joints(platform_.kinematics(), displacement, command_.roll_rad, command_.pitch_rad);
  if (!joints) return 0;
  torques_ = joint_space_torques(platform_.differential(), *joints - platform_.joint_angles(), stiffness);
  const double force = platform_.force_of(torques_);
  if (force <= command_.force_n) return force;
  torques_ *= command_.force_n / force;
  return command_.force_n;
}

void Rrs3Device::step() noexcept {
  PlatformDrive now{.roll_rad = command_.roll_rad, .pitch_rad = command_.pitch_rad};
  if (position_controlled()) {
    now.hold_n_per_m = command_.stiffness_n_per_m;
    now.force_n = drive_to_position();
  } else {
    now.force_n = drive();
  }
  platform_.step(now);
}

void Rrs3Device::advance_to(std::int64_t now_ns) noexcept {
  if (now_ns - time_ns_ > kMostStepsAtOnce * kPlatformStep_ns) {
    neutral();
    time_ns_ = now_ns;
    return;
  }
  while (time_ns_ + kPlatformStep_ns <= now_ns) {
    // The device's own watchdog: without commands it lets go.
    if (time_ns_ - written_ns_ > kMaxAge_ns) let_go();
    step();
    time_ns_ += kPlatformStep_ns;
  }
}

DeviceStatus Rrs3Device::read(std::int64_t now_ns, DeviceReading& reading) noexcept {
  advance_to(now_ns);
  reading.time_ns = time_ns_;
  reading.force_n = sensor_.measure(platform_.force_n());
  reading.vibration_g = motor_.amplitude_g();
  reading.travel = platform_.coordinates().pz_m;
  reading.platform = platform_.pose();
  return DeviceStatus::ok;
}

DeviceStatus Rrs3Device::write(const DeviceCommand& command, std::int64_t now_ns) noexcept {
  written_ns_ = now_ns;
  if (!all_finite(command)) {
    let_go();
    return DeviceStatus::ok;
  }
  command_ = command;
  command_.force_n = pushes(command.normal) ? std::min(command.force_n, max_force_n_) : 0;
  motor_.set(command.vibration_g, command.vibration_hz);
  return DeviceStatus::ok;
}

}  // namespace jnd
