// Where sessions get their rig: simulated devices, unless the program that was started brings its own.
#pragma once

#include <cstdint>
#include <memory>

#include "devices/clock.h"
#include "devices/rig.h"
#include "devices/rig_factory.h"
#include "protocols/protocol.h"

namespace jnd {

// Thread rule: may be asked from any thread; must live as long as it is set.
class RigSource {
 public:
  virtual ~RigSource() = default;
  // What the rig below says of itself, without making it: RigInfo::simulated decides which kinds of session there are.
  virtual RigInfo info(const Protocol& protocol, const RigSpec& spec) const = 0;
  // On the given clock, which must outlive the rig. Throws InputError where the protocol asks for what is not there,
  // DeviceError where a device does not answer.
  virtual std::unique_ptr<Rig> make(const Protocol& protocol, const RigDescription& rig,
                                    const ParticipantProfile& profile, int participant, std::uint64_t seed,
                                    Clock& clock, const RigOptions& options) const = 0;
};

// Of this process; null: simulated devices (devices/rig_factory.h). Set it before the first session.
void set_rig_source(const RigSource* source) noexcept;

// Of the source that is set.
RigInfo rig_info(const Protocol& protocol, const RigSpec& spec);
std::unique_ptr<Rig> make_rig(const Protocol& protocol, const RigDescription& rig, const ParticipantProfile& profile,
                              int participant, std::uint64_t seed, Clock& clock, const RigOptions& options);

}  // namespace jnd
