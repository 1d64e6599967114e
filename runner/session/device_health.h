// How the devices do, in the operator's words.
#pragma once

#include "devices/rig.h"
#include "runner/session/session_view.h"

namespace jnd {

DeviceHealth health_of(const LoopSnapshot& snapshot);      // while it goes on
DeviceHealth health_of(const Presentation& presentation);  // when it is over, with the devices at rest

}  // namespace jnd
