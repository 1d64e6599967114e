// What a device can do: the numbers a protocol is linted against and the governor enforces.
// JSON form: devices/specs/*.json, read by load_device_spec.
#pragma once

#include <filesystem>
#include <string>

namespace jnd {

struct DeviceSpec {
  std::string name;  // "rrs3"
  std::string title;
  double max_force_n = 0;  // normal force on the finger
  double stroke_m = 0;
  double max_roll_rad = 0, max_pitch_rad = 0;
  double max_joint_speed_rad_per_s = 0;
  double min_vibration_g = 0, max_vibration_g = 0;
  double min_vibration_hz = 0, max_vibration_hz = 0;
  double max_stiffness_n_per_m = 0;  // stable up to here at the loop's rate
  // Geometry of the 3RRS platform (m), as in Chinello 2017 section 3; see devices/rrs3_kinematics.h.
  double a_m = 0, b_m = 0, bh_m = 0, bd_m = 0, l1_m = 0, l2_m = 0, rest_z_m = 0;
};

// Throws InputError.
DeviceSpec load_device_spec(const std::filesystem::path& path);

}  // namespace jnd
