#include "devices/loop/rendering.h"

#include <algorithm>
#include <cmath>

namespace jnd {

Tilt tilt_toward(const Eigen::Vector3d& normal, double sin_yaw, double cos_yaw) noexcept {
  // R e_z = Rz(yaw) (sin pitch cos roll, -sin roll, cos pitch cos roll).
  const double x = cos_yaw * normal.x() + sin_yaw * normal.y();
  const double y = -sin_yaw * normal.x() + cos_yaw * normal.y();
  return {.roll_rad = -std::asin(std::clamp(y, -1.0, 1.0)), .pitch_rad = std::atan2(x, normal.z())};
}

}  // namespace jnd
