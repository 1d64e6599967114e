// A fingertip device: the firmware of devices/hid/firmware on the board of plant_hardware.h, one step a period.
//
// It has a supply of its own: its firmware runs on, watchdog and all, while the cable is out, unless it is bus_powered.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "devices/hid/firmware/jnd_fingertip_state.h"
#include "devices/hid/virtual/plant_hardware.h"
#include "devices/hid/virtual/virtual_device.h"

namespace jnd {

struct FingertipOptions {
  std::string serial = "VF-0001";  // 1 to 16 printable characters
  jnd_finger finger = JND_INDEX;
  double pulp_n_per_m = 1000;
  int rate_hz = 1000;              // steps of the firmware, and telemetry reports, a second; divides 1000
  std::filesystem::path memory{};  // what the firmware stores; empty: until the program ends
  bool bus_powered = false;        // unplugging takes the power away
};

class VirtualFingertip final : public VirtualDevice {
 public:
  // log must outlive the device. Throws InputError for impossible options.
  VirtualFingertip(const FingertipOptions& options, const InputReport& port, EventLog& log);

  HidDescription description() const override;
  std::int64_t period_ns() const noexcept override { return kPlatformStep_ns; }
  void step(std::int64_t timer_ns, bool frozen) override;
  void receive(std::span<const std::uint8_t> report, std::int64_t timer_ns) override;
  bool obey(const DeviceOrder& order) override;
  void jump(std::int64_t by_ns) override { ahead_ns_ += by_ns; }
  void plugged(bool is_plugged) override;
  std::string status() const override;

 private:
  void power_up();
  bool told(std::span<const std::uint8_t, JND_REPORT_SIZE> report);
  void notice(std::int64_t timer_ns);
  std::uint64_t clock_us(std::int64_t timer_ns) const noexcept;
  double since_command_ms(std::int64_t timer_ns) const noexcept;

  FingertipOptions options_;
  jnd_fingertip_config config_;
  EventLog& log_;
  ReportOutlet outlet_;
  PlantHardware hardware_;
  jnd_fingertip firmware_{};
  bool powered_ = true;
  std::int64_t power_up_ns_ = 0, timer_ns_ = 0, ahead_ns_ = 0;
  // What the firmware tells, and what came of it
  jnd_telemetry telemetry_{};
  std::uint8_t state_ = JND_STATE_REST;
  std::uint16_t told_faults_ = 0;
  std::int64_t accepted_ns_ = -1;  // on the timer; below 0: no command yet
  std::int64_t let_go_real_ns_ = 0;
  bool pushes_ = false;
  std::int64_t steps_ = 0, commands_ = 0, requests_ = 0;
};

}  // namespace jnd
