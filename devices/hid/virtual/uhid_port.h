// A HID device made of software: /dev/uhid of the Linux kernel. To every program on the machine it is a device that was
// plugged in, with a hidraw node of its own.
//
// Thread rule: one thread. Nothing waits: fd() can be polled for events.
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

class UhidPort {
 public:
  // Throws DeviceError where there is no /dev/uhid, or this login may not open it; it says what to do.
  UhidPort();
  ~UhidPort();
  UhidPort(const UhidPort&) = delete;
  UhidPort& operator=(const UhidPort&) = delete;

  // Throws DeviceError where the kernel refuses the description.
  void plug(const HidDescription& description);
  void unplug();
  bool plugged() const noexcept { return plugged_; }
  bool opened() const noexcept { return opened_; }  // by the host
  int fd() const noexcept { return fd_; }

  // Handles one event of the kernel; false: there was none. An output report goes to `output`, its id first.
  bool serve(const std::function<void(std::span<const std::uint8_t>)>& output);
  // An input report, its id first where reports are numbered. False where the device is not open.
  bool send(std::span<const std::uint8_t> report) const noexcept;

 private:
  int fd_ = -1;
  bool plugged_ = false;
  bool started_ = false;  // the kernel has made the device that was plugged last
  bool opened_ = false;
};

}  // namespace jnd
