// What is behind a port: a device that steps by its own timer, takes output reports and sends input reports. The
// loop (device_loop.h) owns the time and the plug; a device owns everything else.
//
// Thread rule: the loop's thread only.
#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "devices/hid/firmware/jnd_report.h"
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

// What happened to a virtual device and when: a JSON object a line, with the time on CLOCK_MONOTONIC in seconds. Tests
// judge watchdogs by it.
class EventLog {
 public:
  EventLog() = default;  // keeps nothing
  // Throws DeviceError where the file cannot be written.
  explicit EventLog(const std::filesystem::path& file);

  // members: further JSON members without braces, or empty. Every line is handed to the system at once.
  void write(std::string_view event, std::string_view members);

 private:
  struct Close {
    void operator()(std::FILE* file) const noexcept { (void)std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Close> file_;
};

// CLOCK_MONOTONIC.
std::int64_t monotonic_ns() noexcept;

// A text as JSON writes it, with its quotes. Bytes beyond ASCII are passed through.
std::string json_text(std::string_view text);

// The way of numbered input reports out of a virtual device, with the faults that may be asked for on it.
class ReportOutlet {
 public:
  // stream: the id of the report that comes by itself: telemetry, or poses. Only it is dropped or damaged.
  ReportOutlet(std::uint8_t stream, InputReport port);

  // False where the host has not opened the device. A dropped report counts as taken.
  bool send(std::span<const std::uint8_t, JND_REPORT_SIZE> report);
  bool obey(const DeviceOrder& order) noexcept;

  std::int64_t sent() const noexcept { return sent_; }  // of the stream, damaged ones among them
  std::int64_t dropped() const noexcept { return dropped_; }
  std::int64_t damaged() const noexcept { return damaged_; }
  std::int64_t answered() const noexcept { return answered_; }

 private:
  std::uint8_t stream_;
  InputReport port_;
  std::int64_t to_drop_ = 0, to_damage_ = 0;
  bool wrong_version_ = false;
  std::int64_t sent_ = 0, dropped_ = 0, damaged_ = 0, answered_ = 0;
};

// The report as a device of another version would send it: with that version, and, on its identity page, no other. The
// identity page itself keeps version 1, as the protocol demands.
std::array<std::uint8_t, JND_REPORT_SIZE> in_version(std::span<const std::uint8_t, JND_REPORT_SIZE> report,
                                                     std::uint8_t version) noexcept;

// The report descriptors of the virtual devices; those of a fingertip device and a tracker as in
// devices/hid/PROTOCOL.md.

inline constexpr std::uint16_t kVirtualVendor = 0x1209;  // pid.codes; the products are for tests and examples only
inline constexpr std::uint16_t kVirtualProduct = 0x5AFE;
inline constexpr std::uint16_t kVirtualButtonsProduct = 0x5AFF;

std::vector<std::uint8_t> fingertip_descriptor();
std::vector<std::uint8_t> tracker_descriptor();
// An ordinary gamepad: a stick of two axes, one byte each, and eight buttons in a third; not numbered.
std::vector<std::uint8_t> gamepad_descriptor();

}  // namespace jnd
