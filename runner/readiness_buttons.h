// The participant's buttons, as an item of a session's readiness.
#pragma once

#include "devices/machine_checks.h"
#include "runner/button_box.h"

namespace jnd {

MachineCheck check_buttons(const ButtonBox& box);

}  // namespace jnd
