#include "devices/rrs3/rrs3_statics.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace jnd {

Eigen::Vector3d joint_torques(const Rrs3Differential& at, const Wrench& wrench) noexcept {
  // H^T w without the zeros and ones of (17).
  const double fx = wrench[0], fy = wrench[1], mz = wrench[5];
  const Eigen::Vector3d load(wrench[2], at.h(0, 1) * fx + at.h(1, 1) * fy + wrench[3] + at.h(5, 1) * mz,
                             at.h(0, 2) * fx + at.h(1, 2) * fy + wrench[4] + at.h(5, 2) * mz);
  // J^T tau = load by Cramer's rule on the rows of J: the columns of J^T.
  const Eigen::Vector3d a = at.j.row(0), b = at.j.row(1), c = at.j.row(2);
  const Eigen::Vector3d bc = b.cross(c);
  return Eigen::Vector3d(load.dot(bc), load.dot(c.cross(a)), load.dot(a.cross(b))) / a.dot(bc);
}

double force_along(const Rrs3Differential& at, const Eigen::Vector3d& torques,
                   const Eigen::Vector3d& direction) noexcept {
  // H's first column is [0, 0, 1, 0, 0, 0]: only the force's z component works in vz.
  return at.j.col(0).dot(torques) / direction.z();
}

Eigen::Matrix3d joint_stiffness(const Rrs3Differential& at, double translational_n_per_m,
                                double rotational_n_m_per_rad) noexcept {
  Wrench diagonal;
  diagonal << translational_n_per_m, translational_n_per_m, translational_n_per_m, rotational_n_m_per_rad,
      rotational_n_m_per_rad, rotational_n_m_per_rad;
  const Eigen::Matrix3d inverse = at.j.inverse();
  const Eigen::Matrix<double, 6, 3> motion = at.h * inverse;
  return motion.transpose() * diagonal.asDiagonal() * motion;
}

}  // namespace jnd
