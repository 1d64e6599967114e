// A connection that a rig's device depends on.
#pragma once

#include <string>

#include "devices/emergency_stop.h"
#include "devices/rig.h"

namespace jnd {

// Thread rule: any thread.
class RigLink {
 public:
  virtual ~RigLink() = default;
  virtual DeviceLinkReport report() const = 0;
  // What is missing, in the operator's words; empty: nothing.
  virtual std::string missing() const = 0;
  // From now on the stop button on the device latches `stop`, at once; null: no more. `stop` must live until then.
  virtual void stop_with(EmergencyStop* stop) noexcept = 0;
};

}  // namespace jnd
