// Statics of the 3RRS platform by virtual work (Chinello et al. 2017, (23)..(26), (35)): wrench <-> joint torques.
//
// w = [f, m] is what the platform does to the finger, at O1, in S0: N and N m. Torques are N m. Nothing allocates.
#pragma once

#include <Eigen/Core>

#include "devices/rrs3/rrs3_kinematics.h"

namespace jnd {

using Wrench = Eigen::Matrix<double, 6, 1>;

// (26): tau = J^-T H^T w.
Eigen::Vector3d joint_torques(const Rrs3Differential& at, const Wrench& wrench) noexcept;

// The force along a unit direction that the torques put on a finger which takes no moment, N: the f for which w = [f n,
// 0] does the same work as the torques in vz. direction.z() must not be 0.
double force_along(const Rrs3Differential& at, const Eigen::Vector3d& torques,
                   const Eigen::Vector3d& direction) noexcept;

// (35): Kq = J^-T H^T Kd H J^-1, N m/rad. Exact as d(tau)/dq only where w = 0. Kd = diag(kS, kS, kS, kphi, kphi, kphi).
// The paper's "same values for Kphi" is unstable at 1 kHz as N m/rad: read it as N mm/rad.
Eigen::Matrix3d joint_stiffness(const Rrs3Differential& at, double translational_n_per_m,
                                double rotational_n_m_per_rad) noexcept;

}  // namespace jnd
