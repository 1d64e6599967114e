// A rig that keeps the time of a presentation and renders nothing itself: where the operator's hands hand a specimen
// over, and in the place of a laboratory's own rig wherever that is not there, in simulations and rehearsals.
#pragma once

#include "devices/clock.h"
#include "devices/rig.h"

namespace jnd {

class TimedRig final : public Rig {
 public:
  // clock must outlive it. info: RigInfo::simulated says that nobody feels anything: what is asked counts as delivered
  // then, so that a simulated participant has something to go by. Otherwise nothing is known of it.
  TimedRig(RigInfo info, Clock& clock) : info_(std::move(info)), clock_(clock) {}
  const RigInfo& info() const noexcept override { return info_; }
  // Lasts PresentRequest::explore_s, or until it is enough; so many contacts of a simulated participant take a second
  // each. A stop ends it.
  Presentation present(const PresentRequest& request) override;
  void neutral() noexcept override {}
  void watch(const std::function<void(const LoopSnapshot&)>& look) override { look_ = look; }

 private:
  RigInfo info_;
  Clock& clock_;
  std::function<void(const LoopSnapshot&)> look_;
};

// What it says of itself where it stands for that rig.
RigInfo timed_rig_info(const RigRequest& rig, bool simulated);

}  // namespace jnd
