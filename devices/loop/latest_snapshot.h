// The control loop's latest state, for readers on other threads.
#pragma once

#include "devices/loop/newest_slot.h"
#include "devices/rig.h"

namespace jnd {

using LatestSnapshot = NewestSlot<LoopSnapshot>;

}  // namespace jnd
