// The dialogue of `jnd device learn-buttons`, apart from the terminal and the devices of this machine.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "devices/hid/buttons/button_learner.h"
#include "devices/hid/hid_bus.h"

namespace jnd {

// One entry a path, of the collection that most looks like something with buttons.
std::vector<HidInfo> devices_with_buttons(HidBus& bus);
// "046d:c216 Logitech Dual Action, gamepad, /dev/hidraw0"
std::string described(const HidInfo& info);

// Learns the buttons of setup.info on the calling thread. say: a line for the person; interrupted: whether to give up.
// None where interrupted. Throws DeviceError where the device cannot be opened, goes away, or its buttons cannot be
// learnt.
std::optional<ButtonMapping> learn_buttons(HidBus& bus, const LearnerSetup& setup,
                                           const std::function<void(const std::string&)>& say,
                                           const std::function<bool()>& interrupted);

}  // namespace jnd
