#include "devices/rrs3/rrs3_platform.h"

#include <cmath>

#include <fmt/format.h>

#include "protocols/input/input_error.h"
#include "protocols/rigs/device_models.h"

namespace jnd {

namespace {
// Below this compression (a picometre, a nano-newton) and speed the platform is at rest: it need not be computed.
constexpr double kRest_m = 1e-12;
constexpr double kRest_m_per_s = 1e-9;
constexpr double kStep_s = 1e-9 * static_cast<double>(kPlatformStep_ns);
constexpr HardLimits kHard = hard_limits(DeviceModel::rrs3);
}  // namespace

Rrs3Platform::Rrs3Platform(const DeviceSpec& spec, double pulp_stiffness_n_per_m)
    : kinematics_(geometry_of(spec)),
      pulp_n_per_m_(pulp_stiffness_n_per_m),
      joint_step_rad_(limit_in_force(spec.max_joint_speed_rad_per_s, kHard.joint_speed_rad_per_s) * kStep_s) {
  const double stroke_m = limit_in_force(spec.stroke_m, kHard.stroke_m);
  if (!(pulp_n_per_m_ > 0) || !std::isfinite(pulp_n_per_m_) || spec.max_force_n / pulp_n_per_m_ > stroke_m / 2)
    throw InputError(fmt::format(
        "a finger pulp of {} N/m lets the platform of {} go {:.1f} mm at {} N, more than half its stroke of {:.1f} mm: "
        "give pulp_stiffness_n_per_m of at least {:.0f}",
        pulp_n_per_m_, spec.name, 1e3 * spec.max_force_n / pulp_n_per_m_, spec.max_force_n, 1e3 * stroke_m,
        std::ceil(2 * spec.max_force_n / stroke_m)));
  if (!solve_pose({.pz_m = spec.rest_z_m}))
    throw InputError(fmt::format("the geometry of {} cannot hold its rest pose at z = {} m: check the lengths",
                                 spec.name, spec.rest_z_m));
  rest_configuration_ = configuration_;
  rest_differential_ = differential_;
  free_ = motion_of(pulp_n_per_m_);
  held_ = free_;
  rest();
}

Rrs3Platform::Motion Rrs3Platform::motion_of(double stiffness_n_per_m) noexcept {
  // m u'' + 2 sqrt(m k) u' + k u = F, F constant over a step: with y = u - F / k and omega = sqrt(k / m),
  // y(t) = e^(-omega t) ((1 + omega t) y + t u'), u'(t) = e^(-omega t) ((1 - omega t) u' - omega^2 t y). Exact and
  // stable.
  const double omega = std::sqrt(stiffness_n_per_m / kPlatformMass_kg);
  const double e = std::exp(-omega * kStep_s);
  return {.stiffness_n_per_m = stiffness_n_per_m,
          .decay = e * (1 + omega * kStep_s),
          .from_velocity = e * kStep_s,
          .onto_velocity = -e * omega * omega * kStep_s,
          .damped = e * (1 - omega * kStep_s)};
}

void Rrs3Platform::rest() noexcept {
  compression_m_ = velocity_m_per_s_ = 0;
  at_ = {.pz_m = kinematics_.geometry().rest_z_m};
  configuration_ = rest_configuration_;
  differential_ = rest_differential_;
}

bool Rrs3Platform::solve_pose(const Rrs3Coordinates& at) noexcept {
  const std::optional<Rrs3Configuration> configuration = kinematics_.configuration(at);
  if (!configuration) return false;
  const std::optional<Rrs3Differential> differential = kinematics_.differential(*configuration);
  if (!differential) return false;
  at_ = at;
  configuration_ = *configuration;
  differential_ = *differential;
  return true;
}

double Rrs3Platform::force_of(const Eigen::Vector3d& torques) const noexcept {
  return force_along(differential_, torques, normal());
}

PlatformPose Rrs3Platform::pose() const noexcept {
  return {.pz_m = at_.pz_m,
          .roll_rad = at_.roll_rad,
          .pitch_rad = at_.pitch_rad,
          .sin_yaw = configuration_.sin_yaw,
          .cos_yaw = configuration_.cos_yaw};
}

// One step of the roll and pitch servos, as far as the joints' speed allows. False at a mechanical stop.
bool Rrs3Platform::turn(const PlatformDrive& drive) noexcept {
  double roll = drive.roll_rad - at_.roll_rad, pitch = drive.pitch_rad - at_.pitch_rad;
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

void Rrs3Platform::step(const PlatformDrive& drive) noexcept {
  const bool at_rest = drive.force_n == 0 && compression_m_ == 0 && velocity_m_per_s_ == 0;
  if (at_rest && drive.roll_rad == at_.roll_rad && drive.pitch_rad == at_.pitch_rad) return;
  const double before = compression_m_;
  double settled = 0;
  const Motion* motion = &free_;
  if (drive.hold_n_per_m > 0) {
    // The servos hold the position within the step too: the torques fall by the gain as the platform moves.
    if (held_.stiffness_n_per_m != pulp_n_per_m_ + drive.hold_n_per_m)
      held_ = motion_of(pulp_n_per_m_ + drive.hold_n_per_m);
    motion = &held_;
    settled = before + (drive.force_n - pulp_n_per_m_ * before) / held_.stiffness_n_per_m;
  } else {
    settled = drive.force_n / pulp_n_per_m_;
  }
  const double offset = before - settled, velocity = velocity_m_per_s_;
  compression_m_ = settled + motion->decay * offset + motion->from_velocity * velocity;
  velocity_m_per_s_ = motion->onto_velocity * offset + motion->damped * velocity;
  if (settled == 0 && std::abs(compression_m_) < kRest_m && std::abs(velocity_m_per_s_) < kRest_m_per_s)
    compression_m_ = velocity_m_per_s_ = 0;
  // The platform rests on its stop where it touches the pulp without force: it never pulls.
  if (compression_m_ < 0) compression_m_ = velocity_m_per_s_ = 0;
  if (!turn(drive)) {  // the linkage stays where it was
    compression_m_ = before;
    velocity_m_per_s_ = 0;
  }
}

}  // namespace jnd
