// What one device can do: the numbers a protocol is linted against and the governor enforces, and its geometry.
// JSON form: devices/specs/rrs3.json and mckibben.json.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/numerics/words.h"
#include "protocols/input/input_error.h"
#include "protocols/input/json_document.h"
#include "protocols/rigs/device_models.h"
#include "protocols/vocabulary.h"

namespace jnd {

// The McKibben haptic finger in numbers: its four-bar linkage, muscle, spring, valve and air, in SI units.
//
// Defaults are Table 1 of "Use of McKibben Muscle in a Haptic Interface"; the symbols are the paper's. Table 1 prints
// g2 as "82", which is g2 = 13 mm. What the paper leaves open: ambient pressure, gravity, and the valve's command
// range.
struct MckibbenParameters {
  // Linkage, Figure 3b. l1: finger link, l2, h2: coupler, l4: rocker, d2: fingertip and g2: centre of mass along the
  // coupler, h0: joint above the rocker's pivot, hx: tendon guide, hx1: tendon on the coupler.
  double l1_m = 0.055, l2_m = 0.005, d2_m = 0.025, g2_m = 0.013, h2_m = 0.007, l4_m = 0.0639;
  double l5max_m = 0.0814;  // tendon between guide and coupler at full flexion
  double h0_m = 0.015, hx_m = 0, hx1_m = 0.018;
  double mc_kg = 0.055;  // equivalent mass of the linkage, at g2

  // Spring parallel to the muscle: Fm = km CAtt + Fm0.
  double km_n_per_m = 140, fm0_n = 13.93;
  double catt1_m = 0.020;  // preload stroke: CAtt at full flexion

  // Muscle. l0: preloaded length; li, ri, si: length, radius and wall of the inner tube at rest; nt: turns of a fibre
  // of length h; E: Young's modulus of the tube.
  double l0_m = 0.162, li_m = 0.110, ri_m = 0.010, si_m = 0.0008, nt = 1.52, h_fibre_m = 0.178, e_pa = 0.95e6;

  // Pressure control valve (10) and fluidic resistance (11).
  double kv_pa_per_v = 1e5, zeta = 1.8, sigma_n_rad_per_s = 140;
  double valve_min_v = 0, valve_max_v = 10;
  double c_m3_per_s_pa = 5.25e-9, b = 0.39;  // sonic conductance, critical pressure ratio

  // Air and surroundings.
  double rho0_kg_per_m3 = 1.18, r_j_per_kg_k = 287.2, temperature_k = 293, p_atm_pa = 101325, g_m_per_s2 = 9.81;
};

// From a JSON object that has every one of these keys. Mistakes go to diagnostics; the values are then not to be used.
MckibbenParameters read_mckibben_parameters(const JsonNode& node, std::vector<Diagnostic>& diagnostics,
                                            const std::string& file);

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
