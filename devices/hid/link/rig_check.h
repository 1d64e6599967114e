// Has this machine what a protocol and a laboratory's rig file ask for: findings of jnd doctor. No program is
// started.
#pragma once

#include <vector>

#include "devices/hid/hid_bus.h"
#include "devices/machine/machine_checks.h"
#include "devices/rigs/rig_file.h"
#include "protocols/protocol.h"

namespace jnd {

// A connected HID device, and whether this login may use it.
struct SeenHid {
  HidInfo info{};
  bool usable = false;
};

// asked: $.rig of a protocol; null: none, and nothing is said of a tracker. file: null where none was given. Findings:
// "devices" and "buttons" where the rig file names some, "tracker". Bad is what a session would be refused for.
Checks check_rig(const RigRequest* asked, const RigFile* file, const std::vector<SeenHid>& seen);

}  // namespace jnd
