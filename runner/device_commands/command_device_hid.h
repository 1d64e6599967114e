// jnd device list, info and test of real devices, and their output.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "devices/hid/hid_bus.h"

namespace jnd {

// Each returns the exit code. They throw DeviceError, InputError and UsageError.
int hid_device_info(HidBus& bus, const std::string& name, bool json);
// yes: the device may press without being asked for.
int hid_device_test(HidBus& bus, const std::string& name, bool json, bool yes);

// An array of every HID device of this machine: where it is, whose it is, and whether this login may use it. Asks those of ours that may be
// used for the finger that they are made for.
nlohmann::ordered_json hid_json(HidBus& bus);
// The same for people, with the udev rules that are missing.
std::string hid_text(const nlohmann::ordered_json& devices);

}  // namespace jnd
