// Runs a virtual device in real time: its steps on the deadlines of its own timer, output reports as they come, orders
// at their times and from the control lines, the cable in and out.
//
// A device's timer does not skip: steps that the machine made late are caught up one by one, with an output report
// between two of them, up to 50; what is more is given up and counted.
#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "devices/hid/virtual/fault_script.h"
#include "devices/hid/virtual/virtual_device.h"

namespace jnd {

// The crystal of a virtual device: its timer runs beside the machine's monotonic clock, and may be a little slow.
class DeviceClock {
 public:
  explicit DeviceClock(std::int64_t real_ns) noexcept : real_ns_(real_ns) {}

  // From that instant on the timer is so many parts per million slow; negative: fast.
  void slow(double ppm, std::int64_t real_ns) noexcept {
    timer_ns_ = timer_ns(real_ns);
    real_ns_ = real_ns;
    rate_ = 1 - 1e-6 * ppm;
  }
  std::int64_t timer_ns(std::int64_t real_ns) const noexcept {
    return timer_ns_ + std::llround(rate_ * static_cast<double>(real_ns - real_ns_));
  }
  std::int64_t real_ns(std::int64_t timer_ns) const noexcept {
    return real_ns_ + std::llround(static_cast<double>(timer_ns - timer_ns_) / rate_);
  }

 private:
  std::int64_t real_ns_, timer_ns_ = 0;
  double rate_ = 1;  // of the timer by the real clock
};

// Lines that come while the program runs: from its standard input, or from a named pipe or file.
//
// Thread rule: one thread. Nothing waits: fd() can be polled.
class ControlLines {
 public:
  // Empty: standard input. A path where there is nothing yet becomes a named pipe. Throws DeviceError where it cannot
  // be opened.
  explicit ControlLines(const std::filesystem::path& path);
  ~ControlLines();
  ControlLines(const ControlLines&) = delete;
  ControlLines& operator=(const ControlLines&) = delete;

  int fd() const noexcept { return fd_; }  // below 0: at its end, nothing comes any more
  // What can be read now; every whole line that is not blank goes to `line`.
  void serve(const std::function<void(std::string_view)>& line);

 private:
  int fd_ = -1;
  bool own_ = false;
  std::string rest_;  // of a line that is not whole yet
};

// Thread rule: one thread. Everything given must outlive the loop.
class DeviceLoop {
 public:
  DeviceLoop(VirtualDevice& device, DevicePort& port, FaultScript& script, ControlLines& control, EventLog& log);

  // Until quit, or until nobody can come to the port any more. Throws DeviceError where the port refuses the device.
  void run();

 private:
  void obey(const DeviceOrder& order, std::int64_t now_ns);
  void pass_on(const DeviceOrder& order);
  void plug();
  void unplug();
  void orders(std::int64_t now_ns);
  void steps();
  bool serve_port(std::int64_t now_ns);
  void wait();
  std::string status() const;

  VirtualDevice& device_;
  DevicePort& port_;
  FaultScript& script_;
  ControlLines& control_;
  EventLog& log_;
  const std::int64_t start_ns_;
  DeviceClock clock_;
  std::int64_t next_ns_ = 0;  // of the next step, on the device's timer
  std::int64_t skipped_ = 0;
  std::optional<std::int64_t> back_ns_;  // when the cable comes back
  std::int64_t frozen_until_ns_ = 0;
  bool quits_ = false;
};

}  // namespace jnd
