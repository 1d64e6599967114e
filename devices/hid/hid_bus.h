// The seam between the program and HID devices: what is connected, and reports in and out. hidapi_bus.h is the real
// one; tests put firmware behind another.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace jnd {

// One HID device, or one of its top-level collections.
struct HidInfo {
  std::string path;  // "/dev/hidraw0"; may be another one after a replug
  std::uint16_t vendor = 0, product = 0;
  std::uint16_t usage_page = 0, usage = 0;
  std::string serial, manufacturer, product_name;  // UTF-8; may be empty
  int interface_number = -1;
  std::string transport = "USB";  // for people; "socket" or "program" for a device that is one (socket/socket_bus.h)
};

// Which device is meant. Called from the thread that looks for it.
using HidSelector = std::function<bool(const HidInfo&)>;

inline constexpr int kHidTimeOut = 0, kHidGone = -1;

// An open device. Thread rule: opened, used and closed (destroyed) by one and the same thread.
class HidHandle {
 public:
  virtual ~HidHandle() = default;
  // One input report, its id first where reports are numbered. Returns its bytes; kHidTimeOut without one within
  // timeout_ms (0: does not wait); kHidGone where the device is no longer there. Throws nothing.
  virtual int read(std::span<std::uint8_t> bytes, int timeout_ms) noexcept = 0;
  // One output report, its id first (0 where reports are not numbered). False where it could not be handed over; may
  // block for seconds where a device does not take it.
  virtual bool write(std::span<const std::uint8_t> bytes) noexcept = 0;
  // The system's words for the last failure of this handle; for messages, never for decisions.
  virtual std::string error() const = 0;
};

// Thread rule: any thread.
class HidBus {
 public:
  virtual ~HidBus() = default;
  virtual std::vector<HidInfo> list() = 0;  // takes milliseconds: never in the loop
  // Throws DeviceError where it is gone, or this login may not use it (it then says what to do).
  virtual std::unique_ptr<HidHandle> open(const std::string& path) = 0;
  // Of devices that the bus was told of and that were not there when it last looked: why; for messages.
  virtual std::string absent() const { return {}; }
};

}  // namespace jnd
