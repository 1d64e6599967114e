// Builds the rig that a protocol asks for.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "devices/clock.h"
#include "devices/contact/virtual_object.h"
#include "devices/participants/simulated_participant.h"
#include "devices/rig.h"
#include "devices/rigs/fingertip_rig.h"
#include "protocols/protocol.h"
#include "protocols/rigs/rig_description.h"

namespace jnd {

// What a protocol's rig is made of, as loaded from files.
struct RigDescription {
  RigSpec spec;
  VirtualObject object{};  // where $.rig.object names one; otherwise the sphere of $.rig.sphere_radius_m is used
  std::map<std::string, VirtualObject> objects{};  // of free interaction, by name
};

// What the rig below says of itself; the log keeps it.
RigInfo simulated_rig_info(const Protocol& protocol, const RigSpec& spec);

// A rig of simulated devices moved by a simulated hand or finger, on the given clock (simulated, or steady for
// rehearsals). Throws InputError where the protocol asks for a device, finger or tracker that does not exist.
std::unique_ptr<Rig> make_simulated_rig(const Protocol& protocol, const RigDescription& rig,
                                        const ParticipantProfile& profile, int participant, std::uint64_t seed,
                                        Clock& clock, const RigOptions& options = {});

// Free interaction is presented in pieces of at most this, s: between them the operator's keys are handled, and records
// stay bounded.
inline constexpr double kLongestFreePiece_s = 10;

// Device-ticks of the longest presentation of a protocol: room for its telemetry without a drop.
std::size_t telemetry_ticks(const Protocol& protocol, const RigSpec& spec) noexcept;

}  // namespace jnd
