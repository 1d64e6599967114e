#include "devices/rrs3_device.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "devices/governor.h"
#include "protocols/input_error.h"

namespace jnd {

namespace {
// Below this compression (a picometre, a nano-newton) and speed the platform is at rest: it need not be computed.
constexpr double kRest_m = 1e-12;
constexpr double kRest_m_per_s = 1e-9;
// More steps than this after the last read and everything has long settled: the model starts from rest.
constexpr std::int64_t kMostSteps = 250;
}  // namespace

Rrs3Device::Rrs3Device(const DeviceSpec& spec, double pulp_stiffness_n_per_m)
    : kinematics_(geometry_of(spec)),
      pulp_n_per_m_(pulp_stiffness_n_per_m),
      joint_step_rad_(spec.max_joint_speed_rad_per_s * 1e-9 * static_cast<double>(kStep_ns)) {
  if (!(pulp_stiffness_n_per_m > 0) || spec.max_force_n / pulp_stiffness_n_per_m > spec.stroke_m / 2)
    throw InputError(fmt::format(
        "a finger pulp of {} N/m lets the platform of {} go {:.1f} mm at {} N, more than half its stroke of {:.1f} mm: "
        "give pulp_stiffness_n_per_m of at least {:.0f}",
        pulp_stiffness_n_per_m, spec.name, 1e3 * spec.max_force_n / pulp_stiffness_n_per_m, spec.max_force_n,
        1e3 * spec.stroke_m, std::ceil(2 * spec.max_force_n / spec.stroke_m)));
  if (!solve_pose({.pz_m = spec.rest_z_m}))
    throw InputError(fmt::format("the geometry of {} cannot hold its rest pose at z = {} m: check the lengths",
                                 spec.name, spec.rest_z_m));
  rest_configuration_ = configuration_;
  rest_differential_ = differential_;

  // m u'' + 2 sqrt(m k) u' + k u = F, F constant over a step: with y = u - F / k and omega = sqrt(k / m),
  // y(t) = e^(-omega t) ((1 + omega t) y + t u'), u'(t) = e^(-omega t) ((1 - omega t) u' - omega^2 t y). Exact and
  // stable.
  const double step_s = 1e-9 * static_cast<double>(kStep_ns);
  const double omega = std::sqrt(pulp_n_per_m_ / kPlatformMass_kg);
  const double e = std::exp(-omega * step_s);
  decay_ = e * (1 + omega * step_s);
  from_velocity_ = e * step_s;
  onto_velocity_ = -e * omega * omega * step_s;
  damped_ = e * (1 - omega * step_s);
  neutral();
}

DeviceStatus Rrs3Device::engage(std::int64_t now_ns) noexcept {
  neutral();
  time_ns_ = written_ns_ = now_ns;
  return DeviceStatus::ok;
}

void Rrs3Device::neutral() noexcept {
  command_ = DeviceCommand{};
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
  const double settled = drive() / pulp_n_per_m_;
  const double before = compression_m_;
  const double offset = before - settled, velocity = velocity_m_per_s_;
  compression_m_ = settled + decay_ * offset + from_velocity_ * velocity;
  velocity_m_per_s_ = onto_velocity_ * offset + damped_ * velocity;
  if (settled == 0 && std::abs(compression_m_) < kRest_m && std::abs(velocity_m_per_s_) < kRest_m_per_s)
    compression_m_ = velocity_m_per_s_ = 0;
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
    if (time_ns_ - written_ns_ > kMaxAge_ns) command_ = DeviceCommand{};
    step();
    time_ns_ += kStep_ns;
  }
}

DeviceStatus Rrs3Device::read(std::int64_t now_ns, DeviceReading& reading) noexcept {
  advance_to(now_ns);
  reading.force_n = pulp_n_per_m_ * compression_m_;
  reading.vibration_g = command_.vibration_g;
  reading.platform = {.pz_m = at_.pz_m,
                      .roll_rad = at_.roll_rad,
                      .pitch_rad = at_.pitch_rad,
                      .sin_yaw = configuration_.sin_yaw,
                      .cos_yaw = configuration_.cos_yaw};
  return DeviceStatus::ok;
}

DeviceStatus Rrs3Device::write(const DeviceCommand& command, std::int64_t now_ns) noexcept {
  command_ = command;
  written_ns_ = now_ns;
  return DeviceStatus::ok;
}

}  // namespace jnd
