// The participant's buttons, as an item of a session's readiness.
#pragma once

#include "devices/hid/buttons/button_box.h"
#include "devices/machine/machine_checks.h"

namespace jnd {

Check check_buttons(const ButtonBox& box);

}  // namespace jnd
