// The bus that a laboratory's rig file asks for: USB, and the devices that are programs.
#pragma once

#include <memory>
#include <vector>

#include "devices/hid/hid_bus.h"
#include "devices/hid/socket/socket_bus.h"
#include "devices/rigs/rig_file.h"

namespace jnd {

// The devices and the tracker of a rig file that are programs; none where all are connected by USB. started: those too
// that are started by this program.
std::vector<SocketDevice> socket_devices(const RigFile& file, bool started = true);

// USB (devices/hid/hidapi_bus.h), and `devices` before it. Throws DeviceError where the system's HID cannot be used.
std::unique_ptr<HidBus> make_bus(std::vector<SocketDevice> devices = {});

}  // namespace jnd
