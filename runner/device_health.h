// How the devices do, in the operator's words.
#pragma once

#include "devices/rig.h"
#include "runner/session_view.h"

namespace jnd {

DeviceHealth health_of(const LoopGlimpse& glimpse);
DeviceHealth health_of(const Presentation& presentation);  // without the force cap, which it does not know

}  // namespace jnd
