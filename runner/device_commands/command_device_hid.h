// jnd device info and test of a real device, and their output.
#pragma once

#include <string>

#include "devices/hid/hid_bus.h"

namespace jnd {

// Each returns the exit code. They throw DeviceError, InputError and UsageError.
int hid_device_info(HidBus& bus, const std::string& name, bool json);
// yes: the device may press without being asked for.
int hid_device_test(HidBus& bus, const std::string& name, bool json, bool yes);

}  // namespace jnd
