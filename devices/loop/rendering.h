// What a contact should feel like: the laws of Chinello et al. 2017 (section 5.1.2), before any limit.
#pragma once

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

#include "protocols/rigs/device_models.h"

namespace jnd {

// Length of the vibration burst at each making of contact (section 5.1.2).
inline constexpr double kBurst_s = 0.100;
// Frequency of the burst. The paper prints none; the eccentric motor's rated frequency lies near the top of its range.
inline constexpr double kBurst_hz = 200;

// (37): f = kS dx, N.
constexpr double contact_force_n(double stiffness_n_per_m, double penetration_m) noexcept {
  return stiffness_n_per_m * penetration_m;
}

// The same with a damper in the contact: f = kS dx + b dx', N. The paper names a matrix Dq as future work; b = 0 is
// (37). damping >= 0, N s/m; penetration_rate > 0 while the finger goes deeper, m/s. No force without penetration, and
// never a negative one: a surface cannot pull a finger that leaves faster than it springs back. A number that is not
// finite stays one, so that the governor sees it.
constexpr double contact_force_n(double stiffness_n_per_m, double penetration_m, double damping_n_s_per_m,
                                 double penetration_rate_m_per_s) noexcept {
  if (penetration_m <= 0) return 0;
  const double force = stiffness_n_per_m * penetration_m + damping_n_s_per_m * penetration_rate_m_per_s;
  return force < 0 ? 0 : force;
}

// (38), burst_amplitude_g of device_models.h, read backwards: the stiffness that an amplitude stands for, N/m.
constexpr double stiffness_of_amplitude_n_per_m(double amplitude_g) noexcept {
  return 1500 * (amplitude_g - 0.4);
}

struct Tilt {
  double roll_rad = 0, pitch_rad = 0;
};

// Roll and pitch that lay the platform's normal along a unit direction of the device frame, at the platform's present
// yaw. Yaw depends on roll and pitch, so the exact tilt is reached over the ticks in which the platform turns.
inline Tilt tilt_toward(const Eigen::Vector3d& normal, double sin_yaw, double cos_yaw) noexcept {
  // R e_z = Rz(yaw) (sin pitch cos roll, -sin roll, cos pitch cos roll).
  const double x = cos_yaw * normal.x() + sin_yaw * normal.y();
  const double y = -sin_yaw * normal.x() + cos_yaw * normal.y();
  return {.roll_rad = -std::asin(std::clamp(y, -1.0, 1.0)), .pitch_rad = std::atan2(x, normal.z())};
}

}  // namespace jnd
