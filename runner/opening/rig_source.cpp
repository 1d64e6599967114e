#include "runner/opening/rig_source.h"

#include <atomic>
#include <utility>

#include <fmt/format.h>

#include "devices/hid/link/hid_rig.h"
#include "devices/rigs/laboratory_rig.h"
#include "devices/rigs/timed_rig.h"
#include "protocols/input/input_error.h"

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
  explicit HidRigs(RigFile file) : file_(std::move(file)), bus_(make_bus(socket_devices(file_))) {}
  RigInfo info(const Protocol& protocol, const RigSpec& spec) const override { return hid_rig_info(protocol, spec); }
  // Connects and lets go again; without a tracker that is no device, whose program is started once only.
  bool look_for_devices(const Protocol& protocol, const RigDescription& rig, const ParticipantProfile& profile,
                        Clock& clock) const override {
    Protocol devices_only = protocol;
    if (devices_only.rig.tracker != "hid") devices_only.rig.tracker = "hand";
    return make_hid_rig(devices_only, rig, file_, profile, 1, 1, clock, *bus_)->connections().on_a_model();
  }
  std::unique_ptr<Rig> make(const Protocol& protocol, const RigDescription& rig, const ParticipantProfile& profile,
                            int participant, std::uint64_t seed, Clock& clock,
                            const RigOptions& options) const override {
    return make_hid_rig(protocol, rig, file_, profile, participant, seed, clock, *bus_, options);
  }

 private:
  RigFile file_;
  std::unique_ptr<HidBus> bus_;  // any thread may use it
};

class SpecimenRigs final : public RigSource {
 public:
  RigInfo info(const Protocol& protocol, const RigSpec&) const override {
    if (protocol.rig.device != kSpecimenRig)
      throw InputError(fmt::format("$.rig.device is \"{}\": --rig specimens is for protocols whose device is \"{}\"",
                                   protocol.rig.device, kSpecimenRig));
    return timed_rig_info(protocol.rig, false);
  }
  std::unique_ptr<Rig> make(const Protocol& protocol, const RigDescription& rig, const ParticipantProfile&, int,
                            std::uint64_t, Clock& clock, const RigOptions&) const override {
    return std::make_unique<TimedRig>(info(protocol, rig.spec), clock);
  }
};

class LaboratoryRigs final : public RigSource {
 public:
  explicit LaboratoryRigs(ExternalSettings settings) : settings_(std::move(settings)) {}
  RigInfo info(const Protocol& protocol, const RigSpec&) const override {
    if (protocol.rig.device != kExternalRig)
      throw InputError(fmt::format("$.rig.device is \"{}\": an external rig is for protocols whose device is \"{}\"",
                                   protocol.rig.device, kExternalRig));
    return laboratory_rig_info(settings_);
  }
  // Starts it and lets it go again.
  bool look_for_devices(const Protocol& protocol, const RigDescription&, const ParticipantProfile&,
                        Clock& clock) const override {
    return LaboratoryRig(settings_, protocol, clock).info().simulated;
  }
  std::unique_ptr<Rig> make(const Protocol& protocol, const RigDescription&, const ParticipantProfile&, int,
                            std::uint64_t, Clock& clock, const RigOptions&) const override {
    return std::make_unique<LaboratoryRig>(settings_, protocol, clock);
  }

 private:
  ExternalSettings settings_;
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

std::unique_ptr<const RigSource> make_laboratory_rigs(ExternalSettings settings) {
  return std::make_unique<LaboratoryRigs>(std::move(settings));
}

std::unique_ptr<const RigSource> make_specimen_rigs() {
  return std::make_unique<SpecimenRigs>();
}

std::unique_ptr<const RigSource> make_hid_rigs(RigFile file) {
  return std::make_unique<HidRigs>(std::move(file));
}

}  // namespace jnd
