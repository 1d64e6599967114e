#include "runner/rig_source.h"

#include <atomic>

namespace jnd {

namespace {

class SimulatedRigs final : public RigSource {
 public:
  RigInfo info(const Protocol& protocol, const RigSpec& spec) const override {
    return simulated_rig_info(protocol, spec);
  }
  std::unique_ptr<Rig> make(const Protocol& protocol, const RigDescription& rig, const ParticipantProfile& profile,
                            int participant, std::uint64_t seed, Clock& clock,
                            const RigOptions& options) const override {
    return make_simulated_rig(protocol, rig, profile, participant, seed, clock, options);
  }
};

const SimulatedRigs kSimulated;
std::atomic<const RigSource*> source_in_use{&kSimulated};

}  // namespace

void set_rig_source(const RigSource* source) noexcept {
  source_in_use.store(source != nullptr ? source : &kSimulated);
}

RigInfo rig_info(const Protocol& protocol, const RigSpec& spec) {
  return source_in_use.load()->info(protocol, spec);
}

std::unique_ptr<Rig> make_rig(const Protocol& protocol, const RigDescription& rig, const ParticipantProfile& profile,
                              int participant, std::uint64_t seed, Clock& clock, const RigOptions& options) {
  return source_in_use.load()->make(protocol, rig, profile, participant, seed, clock, options);
}

}  // namespace jnd
