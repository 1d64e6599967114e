// Devices that are programs: the reports of PROTOCOL.md over a Unix socket instead of USB (PROTOCOL.md, "Without USB").
// To everything behind HidBus they are devices like others: unplugged is a connection that is closed.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "devices/hid/hid_bus.h"

namespace jnd {

// Where such a device is to be found: at a socket, or as a program to be started.
struct SocketDevice {
  std::string path;                    // how the bus calls it, HidInfo::path; each another one
  std::filesystem::path socket{};      // that it serves; empty: see command
  std::vector<std::string> command{};  // program and arguments; its end of the connection is its file descriptor 3
  std::filesystem::path folder{};      // where the program runs; empty: here
};

// The file descriptor of a started program's end.
inline constexpr int kInheritedSocket = 3;

// Thread rule: any thread. A device is asked who it is when it is listed; where it does not answer it is not there. A
// program is started when it is first listed or opened, at most once a second, and ended with the bus.
class SocketBus final : public HidBus {
 public:
  explicit SocketBus(std::vector<SocketDevice> devices);
  ~SocketBus() override;
  SocketBus(const SocketBus&) = delete;
  SocketBus& operator=(const SocketBus&) = delete;

  std::vector<HidInfo> list() override;
  std::unique_ptr<HidHandle> open(const std::string& path) override;
  std::string absent() const override;

 private:
  class Source;
  std::vector<std::unique_ptr<Source>> sources_;
};

// Two buses as one: what either lists, and opened where it is listed. A path that begins with "/dev/hidraw" is of the
// second.
class JoinedBus final : public HidBus {
 public:
  JoinedBus(std::unique_ptr<HidBus> first, std::unique_ptr<HidBus> second);

  std::vector<HidInfo> list() override;
  std::unique_ptr<HidHandle> open(const std::string& path) override;
  std::string absent() const override { return first_->absent(); }

 private:
  std::unique_ptr<HidBus> first_, second_;
};

}  // namespace jnd
