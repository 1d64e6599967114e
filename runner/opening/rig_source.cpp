#include "runner/opening/rig_source.h"

#include <atomic>
#include <utility>

#include "devices/hid/hidapi_bus.h"
#include "devices/hid/link/hid_rig.h"

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

// The clock of a session on real devices is the machine's: its reports are stamped with nothing else.
class HidRigs final : public RigSource {
 public:
  explicit HidRigs(RigFile file) : file_(std::move(file)) {}
  RigInfo info(const Protocol& protocol, const RigSpec& spec) const override { return hid_rig_info(protocol, spec); }
  // Connects and lets go again; without a tracker that is no device, whose program is started once only.
  bool look_for_devices(const Protocol& protocol, const RigDescription& rig, const ParticipantProfile& profile,
                        Clock& clock) const override {
    Protocol devices_only = protocol;
    if (devices_only.rig.tracker != "hid") devices_only.rig.tracker = "hand";
    return make_hid_rig(devices_only, rig, file_, profile, 1, 1, clock, bus_)->connections().on_a_model();
  }
  std::unique_ptr<Rig> make(const Protocol& protocol, const RigDescription& rig, const ParticipantProfile& profile,
                            int participant, std::uint64_t seed, Clock& clock,
                            const RigOptions& options) const override {
    return make_hid_rig(protocol, rig, file_, profile, participant, seed, clock, bus_, options);
  }

 private:
  RigFile file_;
  mutable HidapiBus bus_;  // any thread may use it
};

const SimulatedRigs kSimulated;
std::atomic<const RigSource*> source_in_use{&kSimulated};

}  // namespace

void set_rig_source(const RigSource* source) noexcept {
  source_in_use.store(source != nullptr ? source : &kSimulated);
}

const RigSource& rig_source() noexcept {
  return *source_in_use.load();
}

std::unique_ptr<const RigSource> make_hid_rigs(RigFile file) {
  return std::make_unique<HidRigs>(std::move(file));
}

}  // namespace jnd
