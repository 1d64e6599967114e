// A fingertip device served on a socket by a thread of the test: the firmware on its plant, in real time, on the very
// sockets that a session meets. It can be told what a virtual device can, and killed.
#pragma once

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include <pthread.h>
#include <sched.h>

#include "devices/hid/virtual/device_loop.h"
#include "devices/hid/virtual/socket_port.h"
#include "devices/hid/virtual/virtual_fingertip.h"
#include "tests/wait_until.h"

namespace jnd::testing {

class ServedDevice {
 public:
  ServedDevice(std::filesystem::path socket, const std::string& serial, jnd_finger finger)
      : socket_(std::move(socket)), control_(socket_.string() + ".control"), log_(socket_.string() + ".log") {
    options_.serial = serial;
    options_.finger = finger;
    start();
  }
  ~ServedDevice() { kill(); }
  ServedDevice(const ServedDevice&) = delete;
  ServedDevice& operator=(const ServedDevice&) = delete;

  // Its program begins, or begins again; the socket is there when this returns.
  void start() {
    parts_ = std::make_unique<Parts>(options_, socket_, control_, log_);
    thread_ = std::thread([this] {
      // A device keeps time by a timer of its own: where this login may, whatever else the machine does.
      const sched_param of_hardware{.sched_priority = 60};
      (void)pthread_setschedparam(pthread_self(), SCHED_FIFO, &of_hardware);
      parts_->loop.run();
    });
    (void)wait_until([this] { return std::filesystem::exists(socket_); });
  }
  // An order of a virtual device: "unplug 300".
  void tell(const std::string& order) const { std::ofstream(control_) << order << '\n'; }
  // The program ends: whatever was connected is cut off.
  void kill() {
    if (!thread_.joinable()) return;
    tell("quit");
    thread_.join();
    parts_.reset();
  }
  // How often its program of now has begun to push.
  std::size_t pushes() const {
    std::size_t found = 0;
    std::ifstream log(log_);
    for (std::string line; std::getline(log, line);) found += line.find("\"event\":\"push\"") != std::string::npos;
    return found;
  }
  const std::filesystem::path& socket() const noexcept { return socket_; }

 private:
  struct Parts {
    Parts(const FingertipOptions& options, const std::filesystem::path& socket, const std::filesystem::path& lines,
          const std::filesystem::path& log_file)
        : port(socket),
          log(log_file),
          device(
              options, [this](std::span<const std::uint8_t> report) { return port.send(report); }, log),
          control(lines),
          loop(device, port, script, control, log) {}
    SocketPort port;
    EventLog log;
    VirtualFingertip device;
    FaultScript script;
    ControlLines control;
    DeviceLoop loop;
  };

  std::filesystem::path socket_, control_, log_;
  FingertipOptions options_;
  std::unique_ptr<Parts> parts_;
  std::thread thread_;
};

}  // namespace jnd::testing
