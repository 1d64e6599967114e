#include "devices/hid/link/rig_bus.h"

#include <utility>

#include "devices/hid/hidapi_bus.h"

namespace jnd {

std::vector<SocketDevice> socket_devices(const RigFile& file, bool started) {
  std::vector<SocketDevice> devices;
  for (const WornDevice& worn : file.devices)
    if (!worn.socket.empty() || (started && !worn.command.empty()))
      devices.push_back({.path = worn.path(), .socket = worn.socket, .command = worn.command, .folder = file.folder});
  if (!file.tracker.socket.empty())
    devices.push_back({.path = file.tracker.socket.string(), .socket = file.tracker.socket});
  return devices;
}

std::unique_ptr<HidBus> make_bus(std::vector<SocketDevice> devices) {
  auto usb = std::make_unique<HidapiBus>();
  if (devices.empty()) return usb;
  return std::make_unique<JoinedBus>(std::make_unique<SocketBus>(std::move(devices)), std::move(usb));
}

}  // namespace jnd
