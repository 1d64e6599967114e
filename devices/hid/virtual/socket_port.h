// A device served on a Unix socket instead of USB (PROTOCOL.md, "Without USB"): no kernel module, no rights, no
// hardware. Every program that is connected gets every report, as from a hidraw node.
#pragma once

#include <filesystem>
#include <vector>

#include "devices/hid/socket/local_socket.h"
#include "devices/hid/virtual/virtual_device.h"

namespace jnd {

class SocketPort final : public DevicePort {
 public:
  // Served at a path that plug() makes and unplug() takes away.
  explicit SocketPort(std::filesystem::path path);
  // Served to the one program that has the other end; when that is closed, or at unplug(), it is over.
  explicit SocketPort(OwnedFile connected);
  ~SocketPort() override;
  SocketPort(const SocketPort&) = delete;
  SocketPort& operator=(const SocketPort&) = delete;

  // Throws DeviceError where the path cannot be served.
  void plug(const HidDescription& description) override;
  void unplug() override;
  bool plugged() const noexcept override { return plugged_; }
  bool opened() const noexcept override { return !hosts_.empty(); }
  bool is_over() const noexcept override;
  std::string where() const override { return path_.string(); }
  int fd() const noexcept override { return events_.get(); }
  bool serve(const std::function<void(std::span<const std::uint8_t>)>& output) override;
  // A host that does not read loses what its queue does not hold, and nobody else does.
  bool send(std::span<const std::uint8_t> report) noexcept override;

 private:
  void watch(const OwnedFile& file);
  void take_on();
  void hear(std::vector<OwnedFile>::iterator host, const std::function<void(std::span<const std::uint8_t>)>& output);

  std::filesystem::path path_;  // empty: of a pair
  OwnedFile events_, listening_;
  std::vector<OwnedFile> hosts_;
  bool plugged_ = false;
};

}  // namespace jnd
