// The way of numbered input reports out of a virtual device, with the faults that may be asked for on it.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "devices/hid/firmware/jnd_report.h"
#include "devices/hid/virtual/fault_script.h"
#include "devices/hid/virtual/virtual_device.h"

namespace jnd {

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

}  // namespace jnd
