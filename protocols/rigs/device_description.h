// What one device can do: the numbers a protocol is linted against and the governor enforces, and its geometry.
// JSON form: devices/specs/rrs3.json and mckibben.json.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "analysis/numerics/words.h"
#include "protocols/rigs/device_models.h"
#include "protocols/rigs/mckibben_parameters.h"
#include "protocols/vocabulary.h"

namespace jnd {

enum class Tendon { bilateral, unilateral };  // unilateral: it can pull only, as a real one

// Gains of the force controller inside a McKibben finger, V/N, V/(N s), V s/N.
struct ForceGains {
  double kp = 0, ki = 0, kd = 0;
};

// Of the model's sensors; 0 is ideal.
struct SensorSpec {
  double force_noise_sd_n = 0;    // of one measurement
  double force_resolution_n = 0;  // of a step
  double encoder_pulses = 0;      // a turn, of a joint's encoder
};

// When a device was last calibrated, as its description says.
struct Calibration {
  std::chrono::sys_days date{};
  std::optional<double> valid_days{};  // from then on; none: the description does not say
};

struct DeviceSpec {
  std::string name;  // "rrs3", "mckibben"
  std::string title;
  DeviceModel model = DeviceModel::rrs3;
  double max_force_n = 0;    // on the finger
  double lowest_travel = 0;  // range of the device's own coordinate: platform height in m, or joint angle in rad
  double highest_travel = 0;
  double max_stiffness = 0;   // stable up to here at the loop's rate: N/m, or N/rad of a joint
  Unit unit = Unit::n_per_m;  // of max_stiffness
  SensorSpec sensors;
  std::optional<Calibration> calibration{};

  // 3RRS platform; zero for a joint, which has neither tilt nor vibration. Geometry as in Chinello et al. 2017, section
  // 3; see devices/rrs3/rrs3_kinematics.h.
  double stroke_m = 0;
  double max_roll_rad = 0, max_pitch_rad = 0;
  double max_joint_speed_rad_per_s = 0;
  double min_vibration_g = 0, max_vibration_g = 0;
  double min_vibration_hz = 0, max_vibration_hz = 0;
  double a_m = 0, b_m = 0, bh_m = 0, bd_m = 0, l1_m = 0, l2_m = 0, rest_z_m = 0;

  // McKibben finger.
  MckibbenParameters finger;
  ForceGains gains;
  Tendon tendon = Tendon::unilateral;
  double lever_arm_m = 0;  // travel of the fingertip along the force per angle of the joint, for works and powers
};

// Throws InputError.
DeviceSpec load_device_spec(const std::filesystem::path& path);

inline constexpr auto kTendonWords =
    words<Tendon>({{"bilateral", Tendon::bilateral}, {"unilateral", Tendon::unilateral}});
std::string_view to_string(Tendon tendon) noexcept;

}  // namespace jnd
