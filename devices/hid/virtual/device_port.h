// How a virtual device meets its hosts: as a HID device of the kernel's (uhid_port.h), or on a socket (socket_port.h).
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace jnd {

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

}  // namespace jnd
