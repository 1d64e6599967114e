// Forward kinematics of the 3RRS platform: which pose the joints' encoders stand for (Chinello et al. 2017,
// section 3.1, leaves it open: "in general, admits multiple solutions").
//
// Newton's method on the inverse kinematics from a pose that is known to be near, such as the last tick's, with the
// exact derivative J_xi = J Brate. Of the several assemblies that share the joint angles it returns the one on the
// starting pose's side of the parallel singularities: the only one that the device can reach without losing control.
//
// Thread rule: a pure function. Nothing allocates or throws.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "devices/rrs3/rrs3_kinematics.h"

namespace jnd {

// Largest difference of a joint angle from the asked one that counts as solved, rad: 1e-14 m of the platform.
inline constexpr double kForwardTolerance_rad = 1e-12;

// joint_angles: q as Rrs3Kinematics::joint_angles gives them, rad. from: a reachable pose to start at.
// Empty where `from` is not reachable or singular, where an angle is not finite, and where no pose with these joints
// can be reached from there.
std::optional<Rrs3Coordinates> forward_kinematics(const Rrs3Kinematics& kinematics, const Eigen::Vector3d& joint_angles,
                                                  const Rrs3Coordinates& from) noexcept;

}  // namespace jnd
