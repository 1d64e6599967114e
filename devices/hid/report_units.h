// SI units to the integers of the reports, and back. Pure.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "devices/fingertip_device.h"
#include "devices/hid/firmware/jnd_report.h"
#include "protocols/vocabulary.h"

namespace jnd {

// value / unit, rounded to nearest (halves away from zero), at most what the field holds. A NaN sets `number` to false,
// and is 0; otherwise `number` stays as it is.
template <typename Field>
Field to_field(double value, double unit, bool& number) noexcept {
  if (std::isnan(value)) {
    number = false;
    return 0;
  }
  const double scaled = std::round(value / unit);
  // Both ends of a field of at most 32 bits are exact as double.
  static_assert(sizeof(Field) <= 4);
  if (scaled <= static_cast<double>(std::numeric_limits<Field>::min())) return std::numeric_limits<Field>::min();
  if (scaled >= static_cast<double>(std::numeric_limits<Field>::max())) return std::numeric_limits<Field>::max();
  return static_cast<Field>(scaled);
}

jnd_mode report_mode(RenderingMode mode) noexcept;

// A command of the given mode, without its sequence. A force without the contact that it comes from (as in tests of a
// device) becomes a contact of 1000 N/m that gives it. False where any number is none, or infinite: `out` is then a
// command of mode rest.
bool to_report(const DeviceCommand& command, RenderingMode mode, jnd_command& out) noexcept;

// time_ns: of the readings, on the loop's clock.
DeviceReading to_reading(const jnd_telemetry& telemetry, std::int64_t time_ns) noexcept;

}  // namespace jnd
