// Builds the rig that a protocol asks for.
#pragma once

#include <cstdint>
#include <memory>

#include "devices/clock.h"
#include "devices/rig.h"
#include "devices/simulated_participant.h"
#include "protocols/device_spec.h"
#include "protocols/protocol.h"

namespace jnd {

// What the rig below says of itself; the log keeps it.
RigInfo simulated_rig_info(const Protocol& protocol, const DeviceSpec& spec);

// A rig of simulated devices around a simulated hand, on the given clock (simulated, or steady for rehearsals).
// Throws InputError where the protocol asks for a device, finger or tracker that does not exist.
std::unique_ptr<Rig> make_simulated_rig(const Protocol& protocol, const DeviceSpec& spec,
                                        const ParticipantProfile& profile, int participant, std::uint64_t seed,
                                        Clock& clock);

}  // namespace jnd
