// The most that a device of each model is ever given, whatever its description says: a description may lower a limit,
// never raise it. The reader of descriptions refuses more with words. Force, tilt and vibration are capped once more by
// the governor, force and vibration also by the models of the devices, stroke and joint speed by the platform's model.
// A stiffness gives nothing but forces, which are capped.
#pragma once

#include <algorithm>

#include "protocols/rigs/device_description.h"

namespace jnd {

struct HardLimits {
  double force_n = 0;    // on the finger
  double stiffness = 0;  // N/m, or N/rad of a joint
  // Of a platform; a joint has none.
  double stroke_m = 0;
  double roll_rad = 0, pitch_rad = 0;
  double joint_speed_rad_per_s = 0;
  double vibration_g = 0, vibration_hz = 0;
};

// 3RRS platform: Chinello et al. 2017, Table 1, and the passivity bound of specs/rrs3.json. McKibben finger: "Use of
// McKibben Muscle in a Haptic Interface", the force and the stiffest object of its tests.
constexpr HardLimits hard_limits(DeviceModel model) noexcept {
  if (model == DeviceModel::mckibben) return {.force_n = 30, .stiffness = 50};
  return {.force_n = 4.7,
          .stiffness = 2000,
          .stroke_m = 0.015,
          .roll_rad = 0.6283185307179586,
          .pitch_rad = 0.5235987755982988,
          .joint_speed_rad_per_s = 10.471975511965978,
          .vibration_g = 1,
          .vibration_hz = 240};
}

// A described limit as it holds: at most the hard one, 0 where it is negative or no number.
constexpr double limit_in_force(double described, double hard) noexcept {
  return described > 0 ? std::min(described, hard) : 0;
}

}  // namespace jnd
