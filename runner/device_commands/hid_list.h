// The HID devices of this machine, for jnd device list.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "devices/hid/hid_bus.h"

namespace jnd {

// An array of every device: where it is, whose it is, and whether this login may use it. Asks those of ours that may be
// used for the finger that they are made for.
nlohmann::ordered_json hid_json(HidBus& bus);
// The same for people, with the udev rules that are missing.
std::string hid_text(const nlohmann::ordered_json& devices);

}  // namespace jnd
