// A rig of fingertip devices around one virtual sphere: owns them, and presents through the control loop.
#pragma once

#include <memory>
#include <vector>

#include "devices/control_loop.h"
#include "devices/rig.h"

namespace jnd {

class FingertipRig final : public Rig {
 public:
  // One device a finger, in the protocol's order. The clock must outlive the rig.
  FingertipRig(RigInfo info, std::vector<std::unique_ptr<FingertipDevice>> devices, std::unique_ptr<Tracker> tracker,
               Clock& clock, const DeviceSpec& spec, const Sphere& sphere);

  const RigInfo& info() const noexcept override { return info_; }
  // While the latch is set nothing is presented: the result is an emergency stop of no length.
  Presentation present(const PresentRequest& request) override;
  void neutral() noexcept override;

  const TickRing& last_ticks() const noexcept { return loop_.last_ticks(); }

 private:
  RigInfo info_;
  std::vector<std::unique_ptr<FingertipDevice>> devices_;
  std::unique_ptr<Tracker> tracker_;
  ControlLoop loop_;
};

}  // namespace jnd
