#include "tests/devices/hid/memory_device.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace jnd::testing {

MemoryDevice::MemoryDevice(const jnd_fingertip_config& wanted, const DeviceSpec& spec, double pulp_n_per_m)
    : config(wanted),
      platform_(spec, pulp_n_per_m),
      motor_({.min_g = spec.min_vibration_g,
              .max_g = spec.max_vibration_g,
              .min_hz = spec.min_vibration_hz,
              .max_hz = spec.max_vibration_hz}) {
  power_up();
}

void MemoryDevice::power_up() {
  jnd_hardware hardware{};
  hardware.context = this;
  hardware.time_us = [](void* context) { return self(context).time_us_; };
  hardware.read = [](void* context, jnd_sensors* sensors) {
    const MemoryDevice& me = self(context);
    const Eigen::Vector3d joints = me.platform_.joint_angles();
    for (int i = 0; i < 3; ++i) sensors->joint_rad[i] = static_cast<float>(joints[i]);
    sensors->force_n = static_cast<float>(me.platform_.force_n());
    sensors->vibration_g = static_cast<float>(me.motor_.amplitude_g());
    sensors->temperature_c = std::numeric_limits<float>::quiet_NaN();
    sensors->battery_percent = JND_BATTERY_NONE;
    sensors->stop_button = me.stop_button;
    sensors->ok = true;
  };
  hardware.actuate = [](void* context, const jnd_actuation* actuation) {
    self(context).actuation_ = *actuation;
    self(context).motor_.set(double{actuation->vibration_g}, double{actuation->vibration_hz});
  };
  hardware.send = [](void* context, const std::uint8_t* bytes) -> bool {
    HidReport report{};
    std::copy(bytes, bytes + report.size(), report.begin());
    if (self(context).deliver) self(context).deliver(report);
    return true;
  };
  hardware.load = [](void* context, void* bytes, std::size_t count) -> bool {
    const std::vector<std::uint8_t>& memory = self(context).memory_;
    if (memory.size() != count) return false;
    std::copy(memory.begin(), memory.end(), static_cast<std::uint8_t*>(bytes));
    return true;
  };
  hardware.store = [](void* context, const void* bytes, std::size_t count) -> bool {
    const auto* first = static_cast<const std::uint8_t*>(bytes);
    self(context).memory_.assign(first, first + count);
    return true;
  };
  actuation_ = {};
  platform_.rest();
  jnd_fingertip_init(&firmware_, &config, &hardware);
}

void MemoryDevice::receive(const std::uint8_t* bytes, std::size_t count, std::uint64_t time_us) {
  time_us_ = time_us;
  jnd_fingertip_receive(&firmware_, bytes, count);
}

void MemoryDevice::step(std::uint64_t time_us) {
  time_us_ = time_us;
  const Eigen::Vector3d torques(double{actuation_.torque_n_m[0]}, double{actuation_.torque_n_m[1]},
                                double{actuation_.torque_n_m[2]});
  platform_.step({.force_n = platform_.force_of(torques),
                  .hold_n_per_m = double{actuation_.hold_n_per_m},
                  .roll_rad = double{actuation_.roll_rad},
                  .pitch_rad = double{actuation_.pitch_rad}});
  jnd_fingertip_step(&firmware_);
}

}  // namespace jnd::testing
