// What is behind a port: a device that steps by its own timer, takes output reports and sends input reports. The
// loop (device_loop.h) owns the time and the plug; a device owns everything else.
//
// Thread rule: the loop's thread only.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "devices/hid/virtual/fault_script.h"

namespace jnd {

// How a virtual device meets its hosts: as a HID device of the kernel's (main.cpp), or on a socket (socket_port.h).
struct HidDescription {
  std::string name, phys, serial;  // at most 127, 63, 63 bytes
  std::uint16_t vendor = 0, product = 0;
  std::vector<std::uint8_t> report_descriptor;
};

// Thread rule: one thread. Nothing waits: fd() can be polled for events.
class DevicePort {
 public:
  virtual ~DevicePort() = default;

  // Throws DeviceError where the description is refused, or the port cannot be made again.
  virtual void plug(const HidDescription& description) = 0;
  virtual void unplug() = 0;
  virtual bool plugged() const noexcept = 0;
  virtual bool opened() const noexcept = 0;                // by a host
  virtual bool is_over() const noexcept { return false; }  // no host can come any more
  virtual std::string where() const { return {}; }         // for people: a path that hosts must be told
  virtual int fd() const noexcept = 0;

  // Handles one event; false: there was none. An output report goes to `output`, its id first.
  virtual bool serve(const std::function<void(std::span<const std::uint8_t>)>& output) = 0;
  // An input report, its id first where reports are numbered. False where no host has the device open.
  virtual bool send(std::span<const std::uint8_t> report) noexcept = 0;
};

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
