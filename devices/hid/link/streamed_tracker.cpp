#include "devices/hid/link/streamed_tracker.h"

#include "devices/hid/link/hid_tracker.h"
#include "devices/trackers/process_tracker.h"
#include "devices/trackers/replay_tracker.h"
#include "protocols/input/input_error.h"

namespace jnd {

std::unique_ptr<Tracker> make_streamed_tracker(const std::string& kind, const std::vector<std::string>& fingers,
                                               const TrackerSource& source, HidBus& bus, const Clock& clock) {
  if (kind == "hid")
    return std::make_unique<HidTracker>(bus, source.serial, fingers, source.to_world, clock, source.socket.string());
  if (kind == "process") {
    if (source.command.empty())
      throw InputError(
          "$.rig.tracker of the protocol is \"process\", but the rig file does not say which program: give its "
          "\"tracker\" a \"command\", such as [\"python3\", \"bridge.py\"]");
    return std::make_unique<ProcessTracker>(source.command, source.folder, fingers, source.to_world, clock);
  }
  if (kind == "replay") {
    if (source.replay.empty())
      throw InputError(
          "$.rig.tracker of the protocol is \"replay\", but the rig file does not say which file: give its \"tracker\" "
          "a \"replay\", such as \"poses.txt\"");
    return std::make_unique<ReplayTracker>(source.replay, fingers, source.to_world);
  }
  throw InputError("$.rig.tracker \"" + kind + "\" is no stream of poses: use \"hid\", \"process\" or \"replay\"");
}

}  // namespace jnd
