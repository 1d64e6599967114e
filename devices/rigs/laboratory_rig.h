// A program of the laboratory behind the seam of every rig: what a trial asks becomes a presentation of the external
// rig, and what that says becomes what the log keeps.
#pragma once

#include "devices/external/external_rig.h"
#include "devices/external/rig_fit.h"
#include "devices/rig.h"

namespace jnd {

class LaboratoryRig final : public Rig, private RigButtons {
 public:
  // Starts the rig and waits for its hello. protocol, for its quantity and unit, and clock must outlive it. Throws
  // DeviceError where there is no hello in time, InputError where the rig cannot present what the protocol asks.
  LaboratoryRig(const ExternalSettings& settings, const Protocol& protocol, Clock& clock);

  const RigInfo& info() const noexcept override { return info_; }
  std::int64_t prepare(const PresentRequest& request) override;
  Presentation present(const PresentRequest& request) override;
  void neutral() noexcept override;
  void watch(const std::function<void(const LoopSnapshot&)>& look) override { look_ = look; }
  std::string missing() override { return rig_.missing(); }
  std::string missing_sealed() override { return rig_.missing_sealed(); }
  RigConnections connections() const override;
  Trace take_trace() override { return std::exchange(trace_, {}); }
  RigButtons* buttons() noexcept override { return has_buttons_ ? this : nullptr; }

 private:
  void ask(const std::vector<std::string>& answers) override;
  std::optional<Pressed> pressed() override;
  void withdraw() override;
  void keep(const RigTelemetry& telemetry, double heard_s);
  RenderRequest asked_of(const PresentRequest& request) const;

  // What the rig gets ready for, or is.
  struct Prepared {
    RenderRequest asked;
    std::uint64_t id = 0;
    std::int64_t due_ns = 0;
    bool is_for(const RenderRequest& other) const {
      return other.id == asked.id && other.value == asked.value && other.beside == asked.beside;
    }
  };

  const Protocol& protocol_;
  Clock& clock_;
  const RigTimeOuts time_outs_;
  ExternalRig rig_;
  RigInfo info_;
  std::vector<Trace::Channel> measures_;  // of its hello
  Trace trace_;
  std::optional<Prepared> prepared_;
  bool has_buttons_ = false, holds_ = true;
  double ready_s_ = 0;
  std::uint64_t question_ = 0;  // that a button may answer; 0: none
  std::int64_t asked_ns_ = 0;
  std::vector<std::string> answers_;
  std::function<void(const LoopSnapshot&)> look_;
};

// What a protocol asks of a rig, for rig_problems().
RigDemand rig_demand(const Protocol& protocol);

// What it says of itself before it is started.
RigInfo laboratory_rig_info(const ExternalSettings& settings);

}  // namespace jnd
