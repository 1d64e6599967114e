// Which devices the trials of a study report on: a device a finger, or one on its pulp and one on its joint.
#pragma once

#include <tuple>
#include <vector>

#include "data/study/study.h"
#include "protocols/protocol.h"

namespace jnd {

struct DevicePlace {
  int finger = 0;  // place in RigRequest::fingers
  Channel channel = Channel::cutaneous;
  bool operator==(const DevicePlace&) const = default;
  bool operator<(const DevicePlace& other) const noexcept {
    return std::tie(finger, channel) < std::tie(other.finger, other.channel);
  }
};

// As the first answered trial of each session has them, in the order of fingers, cutaneous first; where no trial was
// answered, one on every finger's pulp of a rig of ours, and none of another. Throws StorageError.
std::vector<DevicePlace> device_places(const Study& study, const Protocol& protocol,
                                       const std::vector<SessionInfo>& sessions);

}  // namespace jnd
