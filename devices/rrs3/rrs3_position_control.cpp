#include "devices/rrs3/rrs3_position_control.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace jnd {

namespace {
// Halvings of a displacement in search of the deepest reachable pose: a micrometre of a metre.
constexpr int kHalvings = 20;
}  // namespace

Rrs3Coordinates pressed_by(const Rrs3Geometry& geometry, double displacement_m, double roll_rad,
                           double pitch_rad) noexcept {
  return {.pz_m = geometry.rest_z_m + displacement_m / (std::cos(roll_rad) * std::cos(pitch_rad)),
          .roll_rad = roll_rad,
          .pitch_rad = pitch_rad};
}

Eigen::Vector3d rotation_vector(const Eigen::Matrix3d& rotation) noexcept {
  const Eigen::Quaterniond q(rotation);  // its vector part is sin(angle / 2) times the axis
  const double sine = q.vec().norm();
  const double angle = 2 * std::atan2(sine, std::abs(q.w()));
  const double scale = sine > 0 ? angle / sine : 2;
  return std::copysign(scale, q.w()) * q.vec();
}

Wrench position_wrench(const Rrs3Pose& at, const Rrs3Pose& desired, double stiffness_n_per_m, double most_n) noexcept {
  const Eigen::Vector3d normal = at.rotation.col(2);
  const double force = std::min(stiffness_n_per_m * normal.dot(desired.position - at.position), most_n);
  Wrench wrench;
  wrench.head<3>() = force * normal;
  wrench.tail<3>() =
      rotational_gain_n_m_per_rad(stiffness_n_per_m) * rotation_vector(desired.rotation * at.rotation.transpose());
  return wrench;
}

std::optional<Eigen::Vector3d> reachable_joints(const Rrs3Kinematics& kinematics, double displacement_m,
                                                double roll_rad, double pitch_rad) noexcept {
  const auto reached = [&](double displacement) {
    return kinematics.configuration(pressed_by(kinematics.geometry(), displacement, roll_rad, pitch_rad));
  };
  std::optional<Rrs3Configuration> deepest = reached(displacement_m);
  if (!deepest) {
    deepest = reached(0);
    double low = 0, high = displacement_m;
    for (int i = 0; deepest && i < kHalvings; ++i) {
      const double middle = (low + high) / 2;
      const std::optional<Rrs3Configuration> there = reached(middle);
      (there ? low : high) = middle;
      if (there) deepest = there;
    }
  }
  if (!deepest) return std::nullopt;
  return kinematics.joint_angles(*deepest);
}

Eigen::Vector3d joint_space_torques(const Rrs3Differential& at, const Eigen::Vector3d& joint_error,
                                    double stiffness_n_per_m) noexcept {
  return joint_stiffness(at, stiffness_n_per_m, rotational_gain_n_m_per_rad(stiffness_n_per_m)) * joint_error;
}

}  // namespace jnd
