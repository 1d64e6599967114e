// What fingertip devices meet in space, and the simulated hand that goes there: the same for simulated rigs and for
// rigs of real devices.
#pragma once

#include <cstdint>
#include <memory>

#include "devices/loop/control_loop.h"
#include "devices/participants/simulated_participant.h"
#include "devices/rigs/rig_factory.h"
#include "devices/tracker.h"
#include "protocols/protocol.h"

namespace jnd {

// The protocol's sphere or object, and those of free interaction. Throws InputError where one does not lie between two
// fingers.
LoopScene fingertip_scene(const Protocol& protocol, const RigDescription& rig);

// Throws InputError as above, and where the fingers would rest inside an object.
std::unique_ptr<Tracker> make_simulated_hand(const Protocol& protocol, const RigDescription& rig,
                                             const ParticipantProfile& profile, int participant, std::uint64_t seed);

}  // namespace jnd
