// Builds a rig of fingertip devices over USB HID, and the bus that a laboratory's rig file asks for: USB, and the devices
// that are programs.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <vector>

#include "devices/clock.h"
#include "devices/hid/hid_bus.h"
#include "devices/hid/socket/socket_bus.h"
#include "devices/participants/simulated_participant.h"
#include "devices/rigs/fingertip_rig.h"
#include "devices/rigs/rig_factory.h"
#include "devices/rigs/rig_file.h"
#include "protocols/protocol.h"

namespace jnd {

// The devices and the tracker of a rig file that are programs; none where all are connected by USB. started: those too
// that are started by this program.
std::vector<SocketDevice> socket_devices(const RigFile& file, bool started = true);

// USB (devices/hid/hidapi_bus.h), and `devices` before it. Throws DeviceError where the system's HID cannot be used.
std::unique_ptr<HidBus> make_bus(std::vector<SocketDevice> devices = {});

// What the rig below says of itself; the log keeps it. With a simulated hand, or poses from a file, it is simulated:
// no real finger is where the devices take it to be.
RigInfo hid_rig_info(const Protocol& protocol, const RigSpec& spec);

// Devices and tracker by the rig file, an empty one for whatever is connected. Waits at most longest_wait for all of them.
// Clock: the machine's monotonic one, on which the bus's reports are stamped. Bus and clock must outlive the rig.
// Throws InputError where protocol and rig file do not fit, DeviceError where a device is missing, cannot do what the
// protocol was checked against, or may not be used by this login.
std::unique_ptr<Rig> make_hid_rig(const Protocol& protocol, const RigDescription& rig, const RigFile& file,
                                  const ParticipantProfile& profile, int participant, std::uint64_t seed, Clock& clock,
                                  HidBus& bus, const RigOptions& options = {},
                                  std::chrono::milliseconds longest_wait = std::chrono::seconds(5));

}  // namespace jnd
