// What is behind a port (device_port.h): a device that steps by its own timer, takes output reports and sends input reports. The
// loop (device_loop.h) owns the time and the plug; a device owns everything else.
//
// Thread rule: the loop's thread only.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include "devices/hid/virtual/device_port.h"
#include "devices/hid/virtual/fault_script.h"

namespace jnd {

// An input report, its id first where reports are numbered. False: the host has not opened the device.
using InputReport = std::function<bool(std::span<const std::uint8_t>)>;

class VirtualDevice {
 public:
  virtual ~VirtualDevice() = default;

  virtual HidDescription description() const = 0;
  // Of its timer, ns.
  virtual std::int64_t period_ns() const noexcept = 0;
  // One period is over; timer_ns: the device's own time, from its start. frozen: its processor stands still.
  virtual void step(std::int64_t timer_ns, bool frozen) = 0;
  // An output report, its id first (0 where reports are not numbered), that came at that time.
  virtual void receive(std::span<const std::uint8_t> report, std::int64_t timer_ns) = 0;
  // False: this kind of device knows no such order.
  virtual bool obey(const DeviceOrder& order) = 0;
  // Of its clock, beyond the timer; a jump ahead.
  virtual void jump(std::int64_t by_ns) = 0;
  // The cable goes, or comes. Whether it takes the power with it is the device's matter.
  virtual void plugged(bool is_plugged) = 0;
  // The device's share of a status line: JSON members without braces.
  virtual std::string status() const = 0;
};

}  // namespace jnd
