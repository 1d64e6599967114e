// The firmware on a model of its platform, in memory: what a bus of the tests has plugged in.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "devices/hid/firmware/jnd_fingertip_state.h"
#include "devices/rrs3/rrs3_platform.h"
#include "devices/rrs3/vibration_motor.h"

namespace jnd::testing {

using HidReport = std::array<std::uint8_t, JND_REPORT_SIZE>;

// Thread rule: the bus's lock.
class MemoryDevice {
 public:
  MemoryDevice(const jnd_fingertip_config& config, const DeviceSpec& spec, double pulp_n_per_m = 1000);
  MemoryDevice(const MemoryDevice&) = delete;
  MemoryDevice& operator=(const MemoryDevice&) = delete;

  void power_up();
  void receive(const std::uint8_t* bytes, std::size_t count, std::uint64_t time_us);
  // One millisecond of platform and firmware.
  void step(std::uint64_t time_us);

  double force_n() const noexcept { return platform_.force_n(); }
  const jnd_fingertip& firmware() const noexcept { return firmware_; }
  jnd_fingertip& firmware() noexcept { return firmware_; }

  jnd_fingertip_config config;
  std::function<void(const HidReport&)> deliver;  // an input report on its way
  bool stop_button = false;

 private:
  static MemoryDevice& self(void* context) { return *static_cast<MemoryDevice*>(context); }

  Rrs3Platform platform_;
  VibrationMotor motor_;
  jnd_actuation actuation_{};
  std::vector<std::uint8_t> memory_;
  std::uint64_t time_us_ = 0;
  jnd_fingertip firmware_{};
};

}  // namespace jnd::testing
