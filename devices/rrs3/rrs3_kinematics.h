// Kinematics of the 3RRS fingertip platform (Chinello et al. 2017, section 3): pose -> joints, and their velocities.
//
// Frame S0 (fixed on the finger): z dorsal, the platform below the body, so pz < 0 and pressing the pulp means pz
// increasing. R = Rz(yaw) Ry(pitch) Rx(roll). Legs stand at azimuth 0, pi + t, pi - t with t = atan2(bd/2, bh); leg i
// moves in the plane of its radial direction e_i and z, about the joint axis u_i = e_i x z; q_i is measured from e_i
// toward +z, elbows outward.
//
// The paper's misprints, and what stands here instead (each checked by finite differences in tests/devices):
//   (1)   yaw is right in print only for b = 2 bh and bd^2/4 = bh (b + bh); the general form is used.
//   (7)   the printed square root loses the sign of the radial distance; alpha = atan2(s_z, s . e_i).
//   (11)  chi is [vz, wx, wy]; the text prints wz.
//   (19), (20) the S terms of E and F have the wrong sign in print; no sign convention of q repairs them.
//   chi = d(xi)/dt is an approximation there; here chi = Brate d(xi)/dt, exactly.
//
// Thread rule: const after construction. Nothing here allocates or throws: an unreachable pose is an empty optional.
#pragma once

#include <array>
#include <optional>

#include <Eigen/Core>

#include "protocols/rigs/device_description.h"

namespace jnd {

// Metres. a: base joints from the axis; b, bh, bd: platform joints B1 = (b, 0), B2,3 = (-bh, -+bd/2); l1, l2: links.
struct Rrs3Geometry {
  double a_m = 0, b_m = 0, bh_m = 0, bd_m = 0, l1_m = 0, l2_m = 0;
  double rest_z_m = 0;  // height of the platform where it touches the pulp without force
};

Rrs3Geometry geometry_of(const DeviceSpec& spec) noexcept;

// xi: the three coordinates that the device controls.
struct Rrs3Coordinates {
  double pz_m = 0, roll_rad = 0, pitch_rad = 0;
};

// The whole pose of the platform, with the yaw and the shift that come with the coordinates.
struct Rrs3Pose {
  Eigen::Matrix3d rotation;  // R, platform to S0
  Eigen::Vector3d position;  // p, platform origin O1
  double sin_yaw = 0, cos_yaw = 1;
};

// Where everything is at one pose. Columns are legs.
struct Rrs3Configuration : Rrs3Pose {
  // Not defaulted: std::optional would fill 350 bytes with zeros first, a tenth of a control step.
  Rrs3Configuration() noexcept {}  // NOLINT(modernize-use-equals-default)

  Eigen::Matrix3d platform_joints;   // b_i
  Eigen::Matrix3d elbows;            // d_i
  Eigen::Matrix<double, 2, 3> knee;  // of the platform joints in the leg's plane, from its base joint: radial, z
  Eigen::Matrix<double, 2, 3> link;  // of the elbows, the same
};

// The velocities at one pose: q' = J chi and twist [v, w] = H chi, chi = [vz, wx, wy].
struct Rrs3Differential {
  Rrs3Differential() noexcept {}  // NOLINT(modernize-use-equals-default): as above

  Eigen::Matrix<double, 6, 3> h;  // (17)
  Eigen::Matrix3d j;              // (22), rad/s per m/s (column 0) and per rad/s
  double det_u = 0;               // of (14)'s dependent block, m; zero where the constraints no longer fix [vx, vy, wz]
};

class Rrs3Kinematics {
 public:
  // Throws InputError where a length is not positive.
  explicit Rrs3Kinematics(const Rrs3Geometry& geometry);

  const Rrs3Geometry& geometry() const noexcept { return geometry_; }

  // (1)..(3), whether the legs can reach it or not. Empty beyond a quarter turn of tilt.
  std::optional<Rrs3Pose> pose(const Rrs3Coordinates& xi) const noexcept;

  // (1)..(4) and the elbows. Empty where a leg cannot reach, or beyond a quarter turn of tilt.
  std::optional<Rrs3Configuration> configuration(const Rrs3Coordinates& xi) const noexcept;

  // (6), (7): joint angles, rad.
  Eigen::Vector3d joint_angles(const Rrs3Configuration& at) const noexcept;

  // (11)..(22). Empty at a singularity: constraint (det U), serial (a leg's lever in F) or parallel (det J) below 1e-9
  // of its scale.
  std::optional<Rrs3Differential> differential(const Rrs3Configuration& at) const noexcept;

  // Brate: chi = Brate xi'.
  static Eigen::Matrix3d rate_map(const Rrs3Configuration& at, double pitch_rad) noexcept;

  // Condition number of J with its translation column times b, so that both columns are in rad/s per rad/s.
  double condition_number(const Eigen::Matrix3d& j) const noexcept;

  // The unit vector u_i of a joint axis, leg 0..2.
  Eigen::Vector3d joint_axis(int leg) const noexcept;

 private:
  bool solve_pose(const Rrs3Coordinates& xi, Rrs3Pose& at) const noexcept;
  bool solve_legs(Rrs3Configuration& at) const noexcept;
  bool solve_rates(const Rrs3Configuration& at, Rrs3Differential& out) const noexcept;

  struct Leg {
    double cos_azimuth = 1, sin_azimuth = 0;
  };
  Rrs3Geometry geometry_;
  std::array<Leg, 3> legs_{};
  Eigen::Matrix3d joints_in_platform_;            // columns B_i in S1
  Eigen::Vector3d axes_x_, axes_y_, axes_cross_;  // x and y of the joint axes u_i, an element a leg, and their product
};

// Yaw of a configuration, rad.
double yaw_of(const Rrs3Pose& at) noexcept;

// Forward kinematics of the 3RRS platform: which pose the joints' encoders stand for (Chinello et al. 2017,
// section 3.1, leaves it open: "in general, admits multiple solutions").
//
// Newton's method on the inverse kinematics from a pose that is known to be near, such as the last tick's, with the
// exact derivative J_xi = J Brate. Of the several assemblies that share the joint angles it returns the one on the
// starting pose's side of the parallel singularities: the only one that the device can reach without losing control.
//
// Thread rule: a pure function. Nothing allocates or throws.

// Largest difference of a joint angle from the asked one that counts as solved, rad: 1e-14 m of the platform.
inline constexpr double kForwardTolerance_rad = 1e-12;

// joint_angles: q as Rrs3Kinematics::joint_angles gives them, rad. from: a reachable pose to start at.
// Empty where `from` is not reachable or singular, where an angle is not finite, and where no pose with these joints
// can be reached from there.
std::optional<Rrs3Coordinates> forward_kinematics(const Rrs3Kinematics& kinematics, const Eigen::Vector3d& joint_angles,
                                                  const Rrs3Coordinates& from) noexcept;

}  // namespace jnd
