// What the reports of a device say, in words for people and in SI units.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

#include "devices/fingertip_device.h"
#include "devices/hid/firmware/jnd_report.h"
#include "protocols/vocabulary.h"

namespace jnd {

std::string serial_of(const jnd_identity& identity);
std::string calibration_id_of(const jnd_identity& identity);        // empty: never calibrated
std::string calibration_id_of(const jnd_certificate& certificate);  // the same
std::string date_text(std::uint32_t yyyymmdd);                      // "2026-03-01"; empty for 0
std::string firmware_text(const jnd_identity& identity);            // "1.0.0"

std::string_view finger_word(unsigned finger) noexcept;  // of jnd_finger: "thumb"; "any"
std::string_view model_word(unsigned model) noexcept;    // of jnd_model: "3RRS fingertip device"
std::string_view state_word(unsigned state) noexcept;    // of jnd_state: "at rest"
std::string fault_words(unsigned bits);                  // of jnd_fault_bit, with commas; empty: none
std::string limit_words(unsigned bits);                  // of jnd_limit_bit
std::string capability_words(unsigned bits);             // of jnd_capability
std::string_view page_word(unsigned page) noexcept;      // of jnd_page_number: "identity"

// SI units to the integers of the reports, and back. Pure.

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
