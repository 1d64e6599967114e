// jnd with a rig that declares itself real: for tests of what only real sessions do. Its devices are the simulated
// ones, no person feels anything, and it is never installed.
#include <cstdint>
#include <memory>

#include "runner/command_line.h"
#include "runner/opening/rig_source.h"

namespace {

using namespace jnd;

// The loop runs on a simulated clock, so that a busy machine cannot make it late: presentations take no time.
class DeclaredRealRig final : public Rig {
 public:
  DeclaredRealRig(const Protocol& protocol, const RigDescription& rig, const ParticipantProfile& profile,
                  int participant, std::uint64_t seed, RigOptions options) {
    options.realtime.reset();
    rig_ = make_simulated_rig(protocol, rig, profile, participant, seed, clock_, options);
    info_ = rig_->info();
    info_.simulated = false;
  }
  const RigInfo& info() const noexcept override { return info_; }
  Presentation present(const PresentRequest& request) override {
    rig_->stop.clear();
    if (stop.latched()) rig_->stop.latch(stop.source());
    return rig_->present(request);
  }
  void neutral() noexcept override { rig_->neutral(); }
  TelemetryRing* telemetry() noexcept override { return rig_->telemetry(); }
  TelemetryRing* live() noexcept override { return rig_->live(); }

 private:
  SimulatedClock clock_{0};
  std::unique_ptr<Rig> rig_;
  RigInfo info_;
};

class DeclaredRealRigs final : public RigSource {
 public:
  RigInfo info(const Protocol& protocol, const RigSpec& spec) const override {
    RigInfo info = simulated_rig_info(protocol, spec);
    info.simulated = false;
    return info;
  }
  std::unique_ptr<Rig> make(const Protocol& protocol, const RigDescription& rig, const ParticipantProfile& profile,
                            int participant, std::uint64_t seed, Clock& /*clock*/,
                            const RigOptions& options) const override {
    return std::make_unique<DeclaredRealRig>(protocol, rig, profile, participant, seed, options);
  }
};

}  // namespace

int main(int argc, char** argv) {
  const DeclaredRealRigs rigs;
  jnd::set_rig_source(&rigs);
  return jnd::run_command_line(argc, argv);
}
