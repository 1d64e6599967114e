#include "devices/rrs3_device.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "devices/governor.h"
#include "devices/rrs3_position_control.h"
#include "protocols/input_error.h"

namespace jnd {

namespace {
// Below this compression (a picometre, a nano-newton) and speed the platform is at rest: it need not be computed.
constexpr double kRest_m = 1e-12;
constexpr double kRest_m_per_s = 1e-9;
// More steps than this after the last read and everything has long settled: the model starts from rest.
constexpr std::int64_t kMostSteps = 250;
// A contact softer than this is none: at 4.7 N its surface would lie metres inside.
constexpr double kSoftest_n_per_m = 1;

bool all_finite(const DeviceCommand& command) noexcept {
  return std::isfinite(command.force_n + command.stiffness_n_per_m + command.normal.x() + command.normal.y() +
                       command.normal.z() + command.roll_rad + command.pitch_rad + command.vibration_g +
                       command.vibration_hz);
}

bool pushes(const Eigen::Vector3d& normal) noexcept {
  return normal.z() > 0 && std::abs(normal.squaredNorm() - 1) < 1e-6;
}

}  // namespace

Rrs3Device::Rrs3Device(const DeviceSpec& spec, const Rrs3DeviceOptions& options)
    : kinematics_(geometry_of(spec)),
      pulp_n_per_m_(options.pulp_stiffness_n_per_m),
      max_force_n_(spec.max_force_n),
      mode_(options.mode),
      sensor_(options.sensor, options.seed),
      motor_({.min_g = spec.min_vibration_g,
              .max_g = spec.max_vibration_g,
              .min_hz = spec.min_vibration_hz,
              .max_hz = spec.max_vibration_hz}),
      joint_step_rad_(spec.max_joint_speed_rad_per_s * 1e-9 * static_cast<double>(kStep_ns)) {
  if (!(pulp_n_per_m_ > 0) || !std::isfinite(pulp_n_per_m_) || spec.max_force_n / pulp_n_per_m_ > spec.stroke_m / 2)
    throw InputError(fmt::format(
        "a finger pulp of {} N/m lets the platform of {} go {:.1f} mm at {} N, more than half its stroke of {:.1f} mm: "
        "give pulp_stiffness_n_per_m of at least {:.0f}",
        pulp_n_per_m_, spec.name, 1e3 * spec.max_force_n / pulp_n_per_m_, spec.max_force_n, 1e3 * spec.stroke_m,
        std::ceil(2 * spec.max_force_n / spec.stroke_m)));
  if (!solve_pose({.pz_m = spec.rest_z_m}))
    throw InputError(fmt::format("the geometry of {} cannot hold its rest pose at z = {} m: check the lengths",
                                 spec.name, spec.rest_z_m));
  rest_configuration_ = configuration_;
  rest_differential_ = differential_;
  free_ = motion_of(pulp_n_per_m_);
  controlled_ = free_;
  neutral();
}

Rrs3Device::Motion Rrs3Device::motion_of(double stiffness_n_per_m) noexcept {
  // m u'' + 2 sqrt(m k) u' + k u = F, F constant over a step: with y = u - F / k and omega = sqrt(k / m),
  // y(t) = e^(-omega t) ((1 + omega t) y + t u'), u'(t) = e^(-omega t) ((1 - omega t) u' - omega^2 t y). Exact and
  // stable.
  const double step_s = 1e-9 * static_cast<double>(kStep_ns);
  const double omega = std::sqrt(stiffness_n_per_m / kPlatformMass_kg);
  const double e = std::exp(-omega * step_s);
  return {.stiffness_n_per_m = stiffness_n_per_m,
          .decay = e * (1 + omega * step_s),
          .from_velocity = e * step_s,
          .onto_velocity = -e * omega * omega * step_s,
          .damped = e * (1 - omega * step_s)};
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
  compression_m_ = velocity_m_per_s_ = 0;
  at_ = {.pz_m = kinematics_.geometry().rest_z_m};
  configuration_ = rest_configuration_;
  differential_ = rest_differential_;
  torques_.setZero();
}

bool Rrs3Device::solve_pose(const Rrs3Coordinates& at) noexcept {
  const std::optional<Rrs3Configuration> configuration = kinematics_.configuration(at);
  if (!configuration) return false;
  const std::optional<Rrs3Differential> differential = kinematics_.differential(*configuration);
  if (!differential) return false;
  at_ = at;
  configuration_ = *configuration;
  differential_ = *differential;
  return true;
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
  const Eigen::Vector3d platform_normal = configuration_.rotation.col(2);
  // While the platform still turns, a force along n would press harder than |f| along the platform's own normal: the
  // finger must never get more than was commanded.
  const double share = std::min(1.0, platform_normal.z() / command_.normal.z());
  Wrench wrench = Wrench::Zero();
  wrench.head<3>() = command_.force_n * share * command_.normal;
  torques_ = joint_torques(differential_, wrench);
  return force_along(differential_, torques_, platform_normal);
}

// The same in the pd modes; negative where the platform lies deeper than it should.
double Rrs3Device::drive_to_position() noexcept {
  const double stiffness = command_.stiffness_n_per_m;
  const double displacement = command_.force_n / stiffness;
  const Eigen::Vector3d platform_normal = configuration_.rotation.col(2);
  torques_.setZero();
  if (mode_ == RenderingMode::pd) {
    const std::optional<Rrs3Pose> desired =
        kinematics_.pose(pressed_by(kinematics_.geometry(), displacement, command_.roll_rad, command_.pitch_rad));
    if (!desired) return 0;
    torques_ = joint_torques(differential_, position_wrench(configuration_, *desired, stiffness, command_.force_n));
    return force_along(differential_, torques_, platform_normal);
  }
  const std::optional<Eigen::Vector3d> joints =
      reachable_joints(kinematics_, displacement, command_.roll_rad, command_.pitch_rad);
  if (!joints) return 0;
  torques_ = joint_space_torques(differential_, *joints - kinematics_.joint_angles(configuration_), stiffness);
  const double force = force_along(differential_, torques_, platform_normal);
  if (force <= command_.force_n) return force;
  torques_ *= command_.force_n / force;
  return command_.force_n;
}

// One step of the roll and pitch servos, as far as the joints' speed allows. False at a mechanical stop.
bool Rrs3Device::turn() noexcept {
  double roll = command_.roll_rad - at_.roll_rad, pitch = command_.pitch_rad - at_.pitch_rad;
  if (roll != 0 || pitch != 0) {
    const Eigen::Vector3d chi =
        Rrs3Kinematics::rate_map(configuration_, at_.pitch_rad) * Eigen::Vector3d(0, roll, pitch);
    const double farthest = (differential_.j * chi).cwiseAbs().maxCoeff();
    const double share = farthest > joint_step_rad_ ? joint_step_rad_ / farthest : 1;
    roll *= share;
    pitch *= share;
  }
  const double new_roll = at_.roll_rad + roll, new_pitch = at_.pitch_rad + pitch;
  const double rest_z = kinematics_.geometry().rest_z_m;
  // Along the platform's normal the pulp lies |compression| deep: pz follows from it.
  const double pz = rest_z + compression_m_ / (std::cos(new_roll) * std::cos(new_pitch));
  return solve_pose({.pz_m = pz, .roll_rad = new_roll, .pitch_rad = new_pitch});
}

void Rrs3Device::step() noexcept {
  const bool at_rest = command_.force_n <= 0 && compression_m_ == 0 && velocity_m_per_s_ == 0;
  if (at_rest && command_.roll_rad == at_.roll_rad && command_.pitch_rad == at_.pitch_rad) {
    torques_.setZero();
    return;
  }
  const double before = compression_m_;
  double settled = 0;
  const Motion* motion = &free_;
  if (position_controlled()) {
    // The servos hold the position within the step too: the torques fall by the gain as the platform moves.
    motion = &controlled_;
    settled = before + (drive_to_position() - pulp_n_per_m_ * before) / controlled_.stiffness_n_per_m;
  } else {
    settled = drive() / pulp_n_per_m_;
  }
  const double offset = before - settled, velocity = velocity_m_per_s_;
  compression_m_ = settled + motion->decay * offset + motion->from_velocity * velocity;
  velocity_m_per_s_ = motion->onto_velocity * offset + motion->damped * velocity;
  if (settled == 0 && std::abs(compression_m_) < kRest_m && std::abs(velocity_m_per_s_) < kRest_m_per_s)
    compression_m_ = velocity_m_per_s_ = 0;
  // The platform rests on its stop where it touches the pulp without force: it never pulls.
  if (compression_m_ < 0) compression_m_ = velocity_m_per_s_ = 0;
  if (!turn()) {  // the linkage stays where it was
    compression_m_ = before;
    velocity_m_per_s_ = 0;
  }
}

void Rrs3Device::advance_to(std::int64_t now_ns) noexcept {
  if (now_ns - time_ns_ > kMostSteps * kStep_ns) {
    neutral();
    time_ns_ = now_ns;
    return;
  }
  while (time_ns_ + kStep_ns <= now_ns) {
    // The device's own watchdog: without commands it lets go.
    if (time_ns_ - written_ns_ > kMaxAge_ns) let_go();
    step();
    motor_.advance(1e-9 * static_cast<double>(kStep_ns));
    time_ns_ += kStep_ns;
  }
}

DeviceStatus Rrs3Device::read(std::int64_t now_ns, DeviceReading& reading) noexcept {
  advance_to(now_ns);
  reading.time_ns = time_ns_;
  reading.force_n = sensor_.measure(pulp_n_per_m_ * compression_m_);
  reading.vibration_g = motor_.amplitude_g();
  reading.travel = at_.pz_m;
  reading.platform = {.pz_m = at_.pz_m,
                      .roll_rad = at_.roll_rad,
                      .pitch_rad = at_.pitch_rad,
                      .sin_yaw = configuration_.sin_yaw,
                      .cos_yaw = configuration_.cos_yaw};
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
  if (position_controlled() && controlled_.stiffness_n_per_m != pulp_n_per_m_ + command_.stiffness_n_per_m)
    controlled_ = motion_of(pulp_n_per_m_ + command_.stiffness_n_per_m);
  return DeviceStatus::ok;
}

}  // namespace jnd
