// A HID device made of software: /dev/uhid of the Linux kernel. To every program on the machine it is a device that was
// plugged in, with a hidraw node of its own.
//
// Thread rule: one thread. Nothing waits: fd() can be polled for events.
#pragma once

#include "devices/hid/virtual/device_port.h"

namespace jnd {

class UhidPort final : public DevicePort {
 public:
  // Throws DeviceError where there is no /dev/uhid, or this login may not open it; it says what to do.
  UhidPort();
  ~UhidPort() override;
  UhidPort(const UhidPort&) = delete;
  UhidPort& operator=(const UhidPort&) = delete;

  // Throws DeviceError where the kernel refuses the description.
  void plug(const HidDescription& description) override;
  void unplug() override;
  bool plugged() const noexcept override { return plugged_; }
  bool opened() const noexcept override { return opened_; }
  int fd() const noexcept override { return fd_; }
  bool serve(const std::function<void(std::span<const std::uint8_t>)>& output) override;
  bool send(std::span<const std::uint8_t> report) noexcept override;

 private:
  int fd_ = -1;
  bool plugged_ = false;
  bool started_ = false;  // the kernel has made the device that was plugged last
  bool opened_ = false;
};

}  // namespace jnd
