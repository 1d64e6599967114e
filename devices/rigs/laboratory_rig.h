// A program of the laboratory behind the seam of every rig: what a trial asks becomes a presentation of the external
// rig, and what that says becomes what the log keeps.
#pragma once

#include "devices/external/external_rig.h"
#include "devices/external/rig_fit.h"
#include "devices/rig.h"

namespace jnd {

class LaboratoryRig final : public Rig {
 public:
  // Starts the rig and waits for its hello. protocol, for its quantity and unit, and clock must outlive it. Throws
  // DeviceError where there is no hello in time, InputError where the rig cannot present what the protocol asks.
  LaboratoryRig(const ExternalSettings& settings, const Protocol& protocol, Clock& clock);

  const RigInfo& info() const noexcept override { return info_; }
  Presentation present(const PresentRequest& request) override;
  void neutral() noexcept override;
  void watch(const std::function<void(const LoopSnapshot&)>& look) override { look_ = look; }
  std::string missing() override { return rig_.missing(); }
  RigConnections connections() const override;

 private:
  const Protocol& protocol_;
  Clock& clock_;
  ExternalRig rig_;
  RigInfo info_;
  std::function<void(const LoopSnapshot&)> look_;
};

// What a protocol asks of a rig, for rig_problems().
RigDemand rig_demand(const Protocol& protocol);

// What it says of itself before it is started.
RigInfo laboratory_rig_info(const ExternalSettings& settings);

}  // namespace jnd
