// What version 1 of the protocol allows in each structure, written from the tables of PROTOCOL.md: a second opinion on
// the codec's own checks.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "devices/hid/firmware/jnd_report.h"

namespace jnd::codec {

inline bool allowed(const jnd_command& of) {
  return of.mode <= 3;
}

inline bool allowed(const jnd_telemetry& of) {
  return of.state <= 2 && of.faults <= 127 && of.limits <= 511 &&
         (of.battery_percent <= 100 || of.battery_percent == 255);
}

inline bool allowed(const jnd_pose& of) {
  double square = 0;
  bool nothing = of.flexion_urad == 0 && !of.has_flexion;
  for (const std::int32_t part : of.orientation) {
    square += std::pow(part / 1073741824.0, 2);
    nothing = nothing && part == 0;
  }
  for (const std::int32_t part : of.position_nm) nothing = nothing && part == 0;
  // The codec's own arithmetic leaves the last bits of each component away: 1e-6 of the sum, at most.
  const bool turned = std::abs(square - 1) < 0.002 + 2e-6;
  return of.finger >= 1 && of.finger <= 5 && (of.seen ? turned : nothing) && (of.has_flexion || of.flexion_urad == 0);
}

inline bool allowed(const jnd_request& of) {
  return of.operation <= 1;
}

inline bool allowed(const jnd_answer& of) {
  return of.result <= 3;
}

template <std::size_t kCount>
bool allowed_text(const char (&text)[kCount], std::size_t least) {
  std::size_t length = 0;
  while (length < kCount && text[length] != '\0') ++length;
  for (std::size_t i = 0; i < kCount; ++i) {
    const int code = static_cast<unsigned char>(text[i]);
    if (i < length ? code < 0x21 || code > 0x7E : code != 0) return false;
  }
  return length >= least;
}

inline bool allowed_date(std::uint32_t date) {
  const std::uint32_t year = date / 10000, month = date / 100 % 100, day = date % 100;
  return date == 0 || (year >= 2000 && year <= 9999 && month >= 1 && month <= 12 && day >= 1 && day <= 31);
}

inline bool allowed(const jnd_identity& of) {
  return of.lowest_version >= 1 && of.highest_version >= of.lowest_version && (of.model == 1 || of.model == 2) &&
         of.finger <= 5 && of.loop_rate_hz >= 1 && of.capabilities <= 255 && allowed_text(of.serial, 1) &&
         allowed_text(of.calibration_id, 0) && allowed_date(of.calibration_date);
}

inline bool allowed(const jnd_limits& of) {
  return of.lowest_height_nm <= of.highest_height_nm && of.least_vibration_mg <= of.most_vibration_mg &&
         of.least_vibration_dhz <= of.most_vibration_dhz;
}

inline bool allowed(const jnd_geometry& of) {
  return of.a_nm > 0 && of.b_nm > 0 && of.bh_nm > 0 && of.bd_nm > 0 && of.l1_nm > 0 && of.l2_nm > 0;
}

inline bool allowed(const jnd_force_table& of) {
  for (int i = 0; i < 6; ++i) {
    if (i >= of.points && (of.sensor_un[i] != 0 || of.force_un[i] != 0)) return false;
    if (i > 0 && i < of.points && (of.sensor_un[i] <= of.sensor_un[i - 1] || of.force_un[i] <= of.force_un[i - 1]))
      return false;
  }
  return of.points == 0 || (of.points >= 2 && of.points <= 6);
}

inline bool allowed(const jnd_certificate& of) {
  return allowed_text(of.calibration_id, 0) && allowed_date(of.date);
}

}  // namespace jnd::codec
