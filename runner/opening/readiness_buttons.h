// The participant's buttons, as an item of a session's readiness.
#pragma once

#include "devices/machine/machine_checks.h"
#include "devices/hid/buttons/button_box.h"

namespace jnd {

MachineCheck check_buttons(const ButtonBox& box);

}  // namespace jnd
