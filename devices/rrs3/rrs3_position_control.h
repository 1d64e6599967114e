// The two position-controlled renderings of the 3RRS device (Chinello et al. 2017, section 4): the platform is sent to
// where the surface would be, with the gain of the rendered stiffness. Pure functions; the damping of (36) is the
// device's.
//
// Kd = diag(kS, kS, kS, kphi, kphi, kphi), kphi = kS read as N mm/rad: the paper's "same values for Kphi" as N m/rad is
// unstable at 1 kHz.
//
// One departure: the task-space law takes the position error along the platform's normal only. The platform cannot move
// sideways without tilting, so with the whole error, which then is vertical, a tilted platform renders kS / n_z^2
// instead of kS: 13 % too stiff at 20 degrees, twice as stiff in the corner of the limits. At zero tilt they are equal.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "devices/rrs3/rrs3_kinematics.h"
#include "devices/rrs3/rrs3_statics.h"

namespace jnd {

// kphi of a translational stiffness, N m/rad.
constexpr double rotational_gain_n_m_per_rad(double stiffness_n_per_m) noexcept {
  return 1e-3 * stiffness_n_per_m;
}

// The pose that lies a displacement (m) into the finger, along the platform's normal at that tilt.
Rrs3Coordinates pressed_by(const Rrs3Geometry& geometry, double displacement_m, double roll_rad,
                           double pitch_rad) noexcept;

// The axis of a rotation times its angle (0..pi), rad.
Eigen::Vector3d rotation_vector(const Eigen::Matrix3d& rotation) noexcept;

// w = Kd [n n^T (pd - p); rotvec(Rd R^T)], n the platform's normal at the actual pose. Its force along n is at most
// most_n, and negative where the platform lies deeper than desired. N, N m.
Wrench position_wrench(const Rrs3Pose& at, const Rrs3Pose& desired, double stiffness_n_per_m, double most_n) noexcept;

// The joint angles of a pose that is so many metres into the finger, or of the deepest before it that the legs reach.
// Empty where the tilt alone is out of reach.
std::optional<Eigen::Vector3d> reachable_joints(const Rrs3Kinematics& kinematics, double displacement_m,
                                                double roll_rad, double pitch_rad) noexcept;

// (36) as printed, without its damping: Kq(q) (qd - q), N m.
Eigen::Vector3d joint_space_torques(const Rrs3Differential& at, const Eigen::Vector3d& joint_error,
                                    double stiffness_n_per_m) noexcept;

}  // namespace jnd
