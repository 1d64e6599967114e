// Makes the tracker that a protocol asks for and a rig file says where to find.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "devices/clock.h"
#include "devices/hid/hid_bus.h"
#include "devices/rigs/rig_file.h"
#include "devices/tracker.h"

namespace jnd {

// kind: "hid", "process" or "replay"; fingers: as in $.rig.fingers. Bus and clock (the loop's, the machine's monotonic
// one) must outlive the tracker. Throws InputError where the rig file does not say where such a tracker is, or its file
// of poses cannot be played. A tracker that is not there yet is no error: it is missing().
std::unique_ptr<Tracker> make_streamed_tracker(const std::string& kind, const std::vector<std::string>& fingers,
                                               const TrackerSource& source, HidBus& bus, const Clock& clock);

}  // namespace jnd
