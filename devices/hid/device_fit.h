// Whether a device can do what a protocol was checked against. Pure.
#pragma once

#include <string>

#include "devices/hid/firmware/jnd_report.h"
#include "protocols/rigs/device_description.h"

namespace jnd {

// The longest that a device may go on by itself after the last command, ms.
inline constexpr int kLongestWatchdog_ms = 100;

// What the device cannot do that the specification says, each with both numbers; empty: nothing. A device that can do
// more is fine. damps: the protocol's contacts have a viscosity.
std::string shortcomings(const DeviceSpec& spec, bool damps, const jnd_identity& identity, const jnd_limits& limits);

}  // namespace jnd
