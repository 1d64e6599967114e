#include "devices/hid/virtual/plant_hardware.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "devices/device_error.h"

namespace jnd {

namespace {

constexpr float kWarm_c = 31, kHot_c = 80;
constexpr std::uint8_t kLowBattery_percent = 3;

std::vector<std::uint8_t> read_memory(const std::filesystem::path& file) {
  if (file.empty() || !std::filesystem::exists(file)) return {};
  std::ifstream in(file, std::ios::binary);
  if (!in) throw DeviceError(fmt::format("cannot read the device's memory {}: check its permissions", file.string()));
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

bool finite(const jnd_actuation& actuation) noexcept {
  return std::isfinite(actuation.torque_n_m[0] + actuation.torque_n_m[1] + actuation.torque_n_m[2] +
                       actuation.hold_n_per_m + actuation.roll_rad + actuation.pitch_rad + actuation.vibration_g +
                       actuation.vibration_hz);
}

Eigen::Vector3d torques_of(const jnd_actuation& actuation) noexcept {
  return {double{actuation.torque_n_m[0]}, double{actuation.torque_n_m[1]}, double{actuation.torque_n_m[2]}};
}

}  // namespace

DeviceSpec plant_spec_of(const jnd_fingertip_config& config) {
  const jnd_limits& limits = config.limits;
  const jnd_geometry& geometry = config.geometry;
  DeviceSpec spec;
  spec.name = "rrs3";
  spec.max_force_n = 1e-6 * limits.most_force_un;
  spec.lowest_travel = 1e-9 * limits.lowest_height_nm;
  spec.highest_travel = 1e-9 * limits.highest_height_nm;
  spec.stroke_m = spec.highest_travel - spec.lowest_travel;
  spec.max_roll_rad = 1e-4 * limits.most_roll_dmrad;
  spec.max_pitch_rad = 1e-4 * limits.most_pitch_dmrad;
  spec.max_joint_speed_rad_per_s = 1e-3 * limits.most_joint_speed_mrad_per_s;
  spec.min_vibration_g = 1e-3 * limits.least_vibration_mg;
  spec.max_vibration_g = 1e-3 * limits.most_vibration_mg;
  spec.min_vibration_hz = 0.1 * limits.least_vibration_dhz;
  spec.max_vibration_hz = 0.1 * limits.most_vibration_dhz;
  spec.a_m = 1e-9 * geometry.a_nm;
  spec.b_m = 1e-9 * geometry.b_nm;
  spec.bh_m = 1e-9 * geometry.bh_nm;
  spec.bd_m = 1e-9 * geometry.bd_nm;
  spec.l1_m = 1e-9 * geometry.l1_nm;
  spec.l2_m = 1e-9 * geometry.l2_nm;
  spec.rest_z_m = 1e-9 * geometry.rest_height_nm;
  return spec;
}

PlantHardware::PlantHardware(const DeviceSpec& spec, double pulp_stiffness_n_per_m, Send send,
                             std::filesystem::path memory)
    : platform_(spec, pulp_stiffness_n_per_m),
      motor_({.min_g = spec.min_vibration_g,
              .max_g = spec.max_vibration_g,
              .min_hz = spec.min_vibration_hz,
              .max_hz = spec.max_vibration_hz}),
      send_(std::move(send)),
      memory_file_(std::move(memory)),
      memory_(read_memory(memory_file_)) {}

jnd_hardware PlantHardware::functions() noexcept {
  return {
      .context = this,
      .time_us = [](void* context) { return static_cast<PlantHardware*>(context)->time_us_; },
      .read = [](void* context, jnd_sensors* sensors) { static_cast<PlantHardware*>(context)->read(*sensors); },
      .actuate = [](void* context,
                    const jnd_actuation* actuation) { static_cast<PlantHardware*>(context)->actuate(*actuation); },
      .send = [](void* context, const std::uint8_t* report) -> bool {
        return static_cast<PlantHardware*>(context)->send_(
            std::span<const std::uint8_t, JND_REPORT_SIZE>(report, JND_REPORT_SIZE));
      },
      .load = [](void* context, void* bytes, size_t count) -> bool {
        return static_cast<PlantHardware*>(context)->load({static_cast<std::uint8_t*>(bytes), count});
      },
      .store = [](void* context, const void* bytes, size_t count) -> bool {
        return static_cast<PlantHardware*>(context)->store({static_cast<const std::uint8_t*>(bytes), count});
      },
  };
}

void PlantHardware::read(jnd_sensors& sensors) const noexcept {
  const Eigen::Vector3d joints = platform_.joint_angles();
  for (int joint = 0; joint < 3; ++joint) sensors.joint_rad[joint] = static_cast<float>(joints[joint]);
  sensors.force_n = static_cast<float>(faults_.stuck_sensor ? stuck_at_n_ : platform_.force_n());
  if (faults_.nan_sensor) sensors.force_n = std::numeric_limits<float>::quiet_NaN();
  sensors.vibration_g = static_cast<float>(motor_.amplitude_g());
  sensors.temperature_c = faults_.hot ? kHot_c : kWarm_c;
  sensors.battery_percent = faults_.low_battery ? kLowBattery_percent : std::uint8_t{JND_BATTERY_NONE};
  sensors.buttons = buttons_;
  sensors.stop_button = faults_.stop_button;
  sensors.ok = true;
}

void PlantHardware::actuate(const jnd_actuation& actuation) noexcept {
  if (!finite(actuation)) {
    ++impossible_;
    let_go();
    return;
  }
  actuation_ = actuation;
  push_n_ = platform_.force_of(torques_of(actuation));
  motor_.set(double{actuation.vibration_g}, double{actuation.vibration_hz});
}

void PlantHardware::let_go() noexcept {
  actuation_ = {};
  push_n_ = 0;
  motor_.stop();
}

void PlantHardware::advance() noexcept {
  push_n_ = platform_.force_of(torques_of(actuation_));
  platform_.step({.force_n = push_n_,
                  .hold_n_per_m = double{actuation_.hold_n_per_m},
                  .roll_rad = double{actuation_.roll_rad},
                  .pitch_rad = double{actuation_.pitch_rad}});
}

void PlantHardware::set_fault(bool BoardFaults::*fault, bool on) noexcept {
  if (fault == &BoardFaults::stuck_sensor && on && !faults_.stuck_sensor) stuck_at_n_ = platform_.force_n();
  faults_.*fault = on;
}

void PlantHardware::set_button(int button, bool pressed) noexcept {
  const auto bit = static_cast<std::uint8_t>(1U << static_cast<unsigned>(button - 1));
  buttons_ = static_cast<std::uint8_t>(pressed ? buttons_ | bit : buttons_ & ~bit);
}

bool PlantHardware::load(std::span<std::uint8_t> bytes) const {
  if (memory_.size() != bytes.size()) return false;
  std::copy(memory_.begin(), memory_.end(), bytes.begin());
  return true;
}

bool PlantHardware::store(std::span<const std::uint8_t> bytes) {
  memory_.assign(bytes.begin(), bytes.end());
  if (memory_file_.empty()) return true;
  std::ofstream out(memory_file_, std::ios::binary | std::ios::trunc);
  for (const std::uint8_t byte : memory_) out.put(static_cast<char>(byte));
  out.close();
  return out.good();
}

}  // namespace jnd
