// Real devices for the device commands: which are connected, which is meant, and a thread to exchange reports with one.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "devices/hid/bench/bench_checks.h"
#include "devices/hid/hid_bus.h"
#include "devices/hid/our_devices.h"
#include "devices/hid/page_exchange.h"

namespace jnd {

bool is_usable(const HidInfo& info) noexcept;  // this login may read and write it
std::string usb_id(const HidInfo& info);       // "1209:5AFE"
std::string way_to(const HidInfo& info);       // "USB 1209:5AFE", "socket"

// Where a device command looks: USB, the devices of a rig file that are programs (empty: none), and the socket that
// `name` is where it is one. Throws InputError for a rig file that is none, DeviceError.
std::unique_ptr<HidBus> bus_for(const std::string& name, const std::string& rig_file);

// The udev rules that are shipped with this program, where they can be found; otherwise empty.
std::string shipped_udev_rules();

// Whether a device command means a rig: a shipped name, or a file that describes one. A path of a HID device, and one
// that is a socket or ends in ".sock", means a device.
bool names_a_rig(const std::string& name);

// A device of ours by serial number or path. Throws InputError where there is none, or several of one number.
HidInfo find_device(HidBus& bus, const std::string& name);

// All pages of a fingertip device, and its newest telemetry meanwhile. Writes nothing.
struct DeviceDescription {
  jnd_identity identity{};
  jnd_limits limits{};
  jnd_geometry geometry{};
  jnd_force_table table{};
  jnd_certificate certificate{};
  jnd_telemetry telemetry{};
  std::int64_t reports = 0;  // of telemetry that came
};
// Throws DeviceError.
DeviceDescription describe(HidHandle& handle, const std::string& name);
// Throws DeviceError where another program drives it just now.
void refuse_if_driven(const DeviceDescription& device, const std::string& name);

// Opens the device and does the job, both on a thread of its own: signals, which look like an unplugged device to
// hidraw, stay with the caller's. Throws what the job throws.
void with_device(HidBus& bus, const HidInfo& info, const std::function<void(HidHandle&)>& job);

// The user's consent to force. yes: given as an option. False: declined. Throws UsageError where there is no terminal
// to ask on and `needed` says that nothing can be done without.
bool may_press(const std::string& what, bool yes, bool needed);

}  // namespace jnd
