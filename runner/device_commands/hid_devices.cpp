#include "runner/device_commands/hid_devices.h"

#include <algorithm>
#include <array>
#include <exception>
#include <filesystem>
#include <thread>

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include "devices/device_error.h"
#include "devices/hid/link/hid_rig.h"
#include "devices/machine/io_thread.h"
#include "devices/realtime.h"
#include "protocols/input/input_error.h"
#include "protocols/input/resources.h"
#include "runner/keys/interrupt.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/standard_streams.h"
#include "runner/terminal/terminal.h"

namespace jnd {

namespace {

bool is_socket_path(const std::string& name) {
  std::error_code error;
  return name.ends_with(".sock") || std::filesystem::is_socket(name, error);
}

}  // namespace

bool is_usable(const HidInfo& info) noexcept {
  if (info.transport != "USB") return true;  // it is listed where it has answered
  return access(info.path.c_str(), R_OK | W_OK) == 0;
}

std::string usb_id(const HidInfo& info) {
  return fmt::format("{:04X}:{:04X}", info.vendor, info.product);
}

std::string way_to(const HidInfo& info) {
  return info.transport == "USB" ? "USB " + usb_id(info) : info.transport;
}

std::unique_ptr<HidBus> bus_for(const std::string& name, const std::string& rig_file) {
  std::vector<SocketDevice> devices;
  if (!rig_file.empty()) devices = socket_devices(load_rig_file(rig_file));
  if (is_socket_path(name)) devices.push_back({.path = name, .socket = name});
  return make_bus(std::move(devices));
}

std::string shipped_udev_rules() {
  return shipped_file("udev", "devices/hid", "70-jnd.rules").string();
}

bool names_a_rig(const std::string& name) {
  if (is_socket_path(name)) return false;
  if (names_a_file(name)) return !name.starts_with("/dev/hidraw") && !std::filesystem::is_character_file(name);
  const std::vector<std::string> shipped = shipped_names(Resource::device_spec);
  return std::find(shipped.begin(), shipped.end(), name) != shipped.end();
}

HidInfo find_device(HidBus& bus, const std::string& name) {
  std::vector<HidInfo> found;
  std::string ours;
  for (const HidInfo& info : bus.list()) {
    if (!is_ours(info)) continue;
    ours += fmt::format("{}{} at {}", ours.empty() ? "" : ", ", info.serial, info.path);
    if (info.path == name || info.serial == name) found.push_back(info);
  }
  if (found.size() == 1) return found.front();
  if (found.size() > 1)
    throw InputError(fmt::format("{} connected devices have the serial number {}: give a path instead ({})",
                                 found.size(), name, ours));
  if (const std::string absent = bus.absent(); !absent.empty()) throw DeviceError(absent);
  std::string rigs;
  for (const std::string& rig : shipped_names(Resource::device_spec)) rigs += (rigs.empty() ? "" : ", ") + rig;
  throw InputError(
      fmt::format("there is no rig '{}'{} (shipped: {}), no file of that name, and no connected device of that serial "
                  "number or path (connected: {}); jnd device list shows them all",
                  name, nearest_shipped(Resource::device_spec, name), rigs, ours.empty() ? "none" : ours));
}

DeviceDescription describe(HidHandle& handle, const std::string& name) {
  DeviceDescription out;
  const auto look = [&out](std::span<const std::uint8_t> report) {
    jnd_telemetry telemetry{};
    if (jnd_decode_telemetry(report.data(), report.size(), &telemetry) != JND_DECODE_OK) return;
    out.telemetry = telemetry;
    ++out.reports;
  };
  PageExchange pages(handle, name, look);
  out.identity = pages.identity();
  if (out.identity.model != JND_MODEL_RRS3)
    throw DeviceError(fmt::format("{}: is a fingertip device of model {}, which this program does not know; update it",
                                  name, out.identity.model));
  out.limits = pages.limits();
  out.geometry = pages.geometry();
  out.table = pages.force_table();
  out.certificate = pages.certificate();
  // The answers may all have come between two reports of telemetry.
  constexpr int kReads = 20, kWait_ms = 10;
  std::array<std::uint8_t, JND_REPORT_SIZE> report{};
  for (int i = 0; i < kReads && out.reports == 0; ++i) {
    const int count = handle.read(report, kWait_ms);
    if (count == kHidGone) throw DeviceError(fmt::format("{}: is gone; look at its cable and try again", name));
    look(std::span(report).first(static_cast<std::size_t>(count)));
  }
  return out;
}

void refuse_if_driven(const DeviceDescription& device, const std::string& name) {
  if (device.reports > 0 && device.telemetry.state == JND_STATE_ACTIVE)
    throw DeviceError(fmt::format("{}: is driven by another program just now; end that first", name));
}

void with_device(HidBus& bus, const HidInfo& info, const std::function<void(HidHandle&)>& job) {
  std::exception_ptr thrown;
  std::thread thread = start_io_thread(
      [&] {
        try {
          const std::unique_ptr<HidHandle> handle = bus.open(info.path);
          job(*handle);
        } catch (...) {
          thrown = std::current_exception();
        }
      },
      kRealtimePriority);
  thread.join();
  if (thrown) std::rethrow_exception(thrown);
}

bool may_press(const std::string& what, bool yes, bool needed) {
  if (yes) return true;
  if (!is_terminal(STDIN_FILENO) || !is_terminal(STDERR_FILENO)) {
    if (needed) throw UsageError("the device would press, and there is no terminal to ask on: give --yes");
    return false;
  }
  print_message("{}\nLet it press? [y/N] ", what);
  std::string line;
  for (char character = 0; !interrupts().end;) {
    pollfd ready{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
    if (poll(&ready, 1, 200) <= 0) continue;
    if (::read(STDIN_FILENO, &character, 1) != 1 || character == '\n') break;
    line += character;
  }
  return line == "y" || line == "Y" || line == "yes";
}

}  // namespace jnd
