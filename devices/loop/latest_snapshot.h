// The control loop's last words about itself, for whoever looks.
#pragma once

#include "devices/loop/newest_slot.h"
#include "devices/rig.h"

namespace jnd {

using LatestSnapshot = NewestSlot<LoopSnapshot>;

}  // namespace jnd
