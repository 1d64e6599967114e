// The board of a fingertip device, as the firmware sees it, made of models: the platform on a compliant pulp, its
// sensors, its vibration motor, buttons and a memory that survives power-down. The force sensor and the joints' are
// exact, but where a fault is asked for.
//
// Thread rule: one thread. The hardware's functions neither allocate nor throw, except those of the memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <vector>

#include "devices/hid/firmware/jnd_fingertip.h"
#include "devices/hid/firmware/jnd_hardware.h"
#include "devices/rrs3/rrs3_platform.h"
#include "devices/rrs3/vibration_motor.h"
#include "protocols/rigs/device_description.h"

namespace jnd {

// The platform that a firmware's maker describes, as the model takes it.
DeviceSpec plant_spec_of(const jnd_fingertip_config& config);

struct BoardFaults {
  bool stuck_sensor = false, nan_sensor = false, hot = false, low_battery = false, stop_button = false;
};

class PlantHardware {
 public:
  // An input report on its way to the host; false: no room.
  using Send = std::function<bool(std::span<const std::uint8_t, JND_REPORT_SIZE>)>;

  // memory: a file that keeps what the firmware stores, or empty: kept until the program ends. Throws InputError for an
  // impossible plant, DeviceError where the file cannot be read.
  PlantHardware(const DeviceSpec& spec, double pulp_stiffness_n_per_m, Send send, std::filesystem::path memory = {});
  PlantHardware(const PlantHardware&) = delete;
  PlantHardware& operator=(const PlantHardware&) = delete;

  // For the firmware; valid as long as this object is.
  jnd_hardware functions() noexcept;

  // What the firmware's clock says from now on, microseconds since power-up.
  void set_time_us(std::uint64_t time_us) noexcept { time_us_ = time_us; }
  // One millisecond of the plant, with what the actuators were last told.
  void advance() noexcept;
  // No power: the actuators let go.
  void let_go() noexcept;

  void set_fault(bool BoardFaults::*fault, bool on) noexcept;
  void set_button(int button, bool pressed) noexcept;  // 1..8

  const Rrs3Platform& platform() const noexcept { return platform_; }
  double force_n() const noexcept { return platform_.force_n(); }  // on the finger, in truth
  double push_n() const noexcept { return push_n_; }               // that the torques ask for just now
  double vibration_g() const noexcept { return motor_.amplitude_g(); }
  std::int64_t impossible() const noexcept { return impossible_; }  // actuations that held no number; none was obeyed

 private:
  void read(jnd_sensors& sensors) const noexcept;
  void actuate(const jnd_actuation& actuation) noexcept;
  bool load(std::span<std::uint8_t> bytes) const;
  bool store(std::span<const std::uint8_t> bytes);

  Rrs3Platform platform_;
  VibrationMotor motor_;
  Send send_;
  std::filesystem::path memory_file_;
  std::vector<std::uint8_t> memory_;
  std::uint64_t time_us_ = 0;
  jnd_actuation actuation_{};
  double push_n_ = 0;
  BoardFaults faults_;
  double stuck_at_n_ = 0;
  std::uint8_t buttons_ = 0;
  std::int64_t impossible_ = 0;
};

}  // namespace jnd
