#include "tests/protocols/rigs.h"

#include <atomic>
#include <fstream>

#include "protocols/input/input_error.h"
#include "tests/catch.h"

namespace jnd::test {

const char* const kRrs3Spec = R"({
  "format": 1,
  "name": "rrs3",
  "title": "for tests",
  "limits": {
    "max_force_n": 4.7, "stroke_m": 0.015, "max_roll_rad": 0.628, "max_pitch_rad": 0.523,
    "max_joint_speed_rad_per_s": 10.4, "min_vibration_g": 0.05, "max_vibration_g": 1,
    "min_vibration_hz": 50, "max_vibration_hz": 240, "max_stiffness_n_per_m": 2000
  },
  "geometry": {"a_m": 0.006, "b_m": 0.01, "bh_m": 0.005, "bd_m": 0.0173205, "l1_m": 0.012, "l2_m": 0.02, "rest_z_m": -0.02}
})";

const char* const kMckibbenSpec = R"({
  "format": 1,
  "name": "mckibben",
  "title": "for tests",
  "notes": ["a note"],
  "limits": {"max_force_n": 20, "min_angle_rad": 0.35, "max_angle_rad": 0.93, "max_stiffness_n_per_rad": 50},
  "finger": {
    "l1_m": 0.055, "l2_m": 0.005, "d2_m": 0.025, "g2_m": 0.013, "h2_m": 0.007, "l4_m": 0.0639, "l5max_m": 0.0814,
    "h0_m": 0.015, "hx_m": 0, "hx1_m": 0.018, "mc_kg": 0.055, "km_n_per_m": 140, "fm0_n": 13.93, "catt1_m": 0.02,
    "l0_m": 0.162, "li_m": 0.11, "ri_m": 0.01, "si_m": 0.0008, "nt": 1.52, "h_fibre_m": 0.178, "e_pa": 950000,
    "kv_pa_per_v": 100000, "zeta": 1.8, "sigma_n_rad_per_s": 140, "valve_min_v": 0, "valve_max_v": 10,
    "c_m3_per_s_pa": 5.25e-9, "b": 0.39, "rho0_kg_per_m3": 1.18, "r_j_per_kg_k": 287.2, "temperature_k": 293,
    "p_atm_pa": 101325, "g_m_per_s2": 9.81
  },
  "control": {"kp": 0.1, "ki": 3, "kd": 0},
  "tendon": "unilateral",
  "lever_arm_m": 0.1
})";

const char* const kTwoDevicesSpec = R"({
  "format": 1,
  "name": "rrs3+mckibben",
  "title": "for tests",
  "cutaneous": "rrs3.json",
  "kinaesthetic": "mckibben.json",
  "lever_arm_m": 0.07
})";

TemporaryFolder::TemporaryFolder() {
  static std::atomic<int> count = 0;
  path_ = std::filesystem::temp_directory_path() /
          ("jnd-rigs-" + std::to_string(reinterpret_cast<std::uintptr_t>(this)) + "-" + std::to_string(count++));
  std::filesystem::create_directory(path_);
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::filesystem::path TemporaryFolder::write(const std::string& name, const std::string& text) const {
  std::ofstream stream(path_ / name, std::ios::binary);
  stream << text;
  REQUIRE(stream.good());
  return path_ / name;
}

DeviceSpec device_from(const std::string& text) {
  const TemporaryFolder folder;
  return load_device_spec(folder.write("device.json", text));
}

std::string device_error(const std::string& text) {
  try {
    device_from(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

RigSpec rig_named(const std::string& name) {
  const TemporaryFolder folder;
  const auto rrs3 = folder.write("rrs3.json", kRrs3Spec);
  const auto mckibben = folder.write("mckibben.json", kMckibbenSpec);
  const auto both = folder.write("rrs3+mckibben.json", kTwoDevicesSpec);
  return load_rig_spec(name == "rrs3" ? rrs3 : name == "mckibben" ? mckibben : both);
}

}  // namespace jnd::test
