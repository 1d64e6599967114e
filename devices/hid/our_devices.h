// Which HID devices speak the report protocol: PROTOCOL.md, "Transport".
#pragma once

#include <string>

#include "devices/hid/firmware/jnd_report.h"
#include "devices/hid/hid_bus.h"

namespace jnd {

inline bool is_fingertip(const HidInfo& info) noexcept {
  return info.usage_page == JND_USAGE_PAGE && info.usage == JND_USAGE_FINGERTIP;
}
inline bool is_tracker(const HidInfo& info) noexcept {
  return info.usage_page == JND_USAGE_PAGE && info.usage == JND_USAGE_TRACKER;
}
inline bool is_ours(const HidInfo& info) noexcept {
  return is_fingertip(info) || is_tracker(info);
}

// For messages: its serial number or, without one, its path.
inline std::string name_of(const HidInfo& info) {
  return info.serial.empty() ? info.path : info.serial;
}

}  // namespace jnd
