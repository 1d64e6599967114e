// Runs a virtual device in real time: its steps on the deadlines of its own timer, output reports as they come, orders
// at their times and from the control lines, the cable in and out.
//
// A device's timer does not skip: steps that the machine made late are caught up one by one, with an output report
// between two of them, up to 50; what is more is given up and counted.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "devices/hid/virtual/control_lines.h"
#include "devices/hid/virtual/device_clock.h"
#include "devices/hid/virtual/device_port.h"
#include "devices/hid/virtual/event_log.h"
#include "devices/hid/virtual/fault_script.h"
#include "devices/hid/virtual/virtual_device.h"

namespace jnd {

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
