// jnd-virtual-device: a fingertip device, a tracker or a button box that exists in software only, for tests, for
// rehearsals and to see what a host sends before there is hardware.
#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <memory>

#include <CLI/CLI.hpp>
#include <fcntl.h>
#include <fmt/format.h>
#include <linux/uhid.h>
#include <sys/prctl.h>
#include <unistd.h>

#include "devices/device_error.h"
#include "devices/hid/socket/socket_bus.h"
#include "devices/hid/virtual/device_loop.h"
#include "devices/hid/virtual/socket_port.h"
#include "devices/hid/virtual/virtual_buttons.h"
#include "devices/hid/virtual/virtual_device.h"
#include "devices/hid/virtual/virtual_fingertip.h"
#include "devices/hid/virtual/virtual_tracker.h"
#include "protocols/input/input_error.h"
#include "protocols/input/read_file.h"
#include "protocols/version.h"

namespace jnd {
namespace {

constexpr const char* kNode = "/dev/uhid";

std::string cannot_open(int error) {
  std::string text = fmt::format("cannot open {}: {}", kNode, std::strerror(error));
  if (error == ENOENT || error == ENODEV)
    return text +
           "; load the kernel's module with \"sudo modprobe uhid\" (a kernel without it, as in many containers, cannot "
           "have virtual devices)";
  if (error == EACCES || error == EPERM)
    return text +
           "; run as root, or let your login use it: put KERNEL==\"uhid\", GROUP=\"plugdev\", MODE=\"0660\" into "
           "/etc/udev/rules.d/70-uhid.rules, then \"sudo udevadm control --reload && sudo udevadm trigger\"";
  return text;
}

template <std::size_t size>
void put_text(std::uint8_t (&to)[size], const std::string& from) {
  std::memset(to, 0, size);
  std::memcpy(to, from.data(), std::min(from.size(), size - 1));
}

// The kernel takes the rest of a short event as zeros.
bool hand_over(int fd, const uhid_event& event, std::size_t size = sizeof(uhid_event)) noexcept {
  ssize_t written = 0;
  do {
    written = ::write(fd, &event, size);
  } while (written < 0 && errno == EINTR);
  return written == static_cast<ssize_t>(size);
}

// A HID device made of software: /dev/uhid of the Linux kernel. To every program on the machine it is a device that was
// plugged in, with a hidraw node of its own.
//
// Thread rule: one thread. Nothing waits: fd() can be polled for events.
class UhidPort final : public DevicePort {
 public:
  // Throws DeviceError where there is no /dev/uhid, or this login may not open it; it says what to do.
  UhidPort() : fd_(::open(kNode, O_RDWR | O_CLOEXEC | O_NONBLOCK)) {
    if (fd_ < 0) throw DeviceError(cannot_open(errno));
  }
  ~UhidPort() override {
    ::close(fd_);  // the kernel unplugs what is still there
  }
  UhidPort(const UhidPort&) = delete;
  UhidPort& operator=(const UhidPort&) = delete;

  // Throws DeviceError where the kernel refuses the description.
  void plug(const HidDescription& description) override {
    uhid_event event{};
    event.type = UHID_CREATE2;
    uhid_create2_req& request = event.u.create2;
    put_text(request.name, description.name);
    put_text(request.phys, description.phys);
    put_text(request.uniq, description.serial);
    if (description.report_descriptor.size() > sizeof request.rd_data)
      throw DeviceError("the report descriptor is longer than the kernel takes");
    std::memcpy(request.rd_data, description.report_descriptor.data(), description.report_descriptor.size());
    request.rd_size = static_cast<std::uint16_t>(description.report_descriptor.size());
    request.bus = BUS_USB;
    request.vendor = description.vendor;
    request.product = description.product;
    started_ = opened_ = false;
    if (!hand_over(fd_, event))
      throw DeviceError(fmt::format("the kernel refuses the virtual device: {}", std::strerror(errno)));
    plugged_ = true;
  }
  void unplug() override {
    if (!plugged_) return;
    uhid_event event{};
    event.type = UHID_DESTROY;
    (void)hand_over(fd_, event);
    plugged_ = started_ = opened_ = false;
  }
  bool plugged() const noexcept override { return plugged_; }
  bool opened() const noexcept override { return opened_; }
  int fd() const noexcept override { return fd_; }
  bool serve(const std::function<void(std::span<const std::uint8_t>)>& output) override {
    uhid_event event{};
    if (::read(fd_, &event, sizeof event) <= 0) return false;
    // After a replug the events of the device that is no more come first: only START makes what follows count.
    switch (event.type) {
      case UHID_START:
        started_ = plugged_;
        break;
      case UHID_STOP:
        started_ = opened_ = false;
        break;
      case UHID_OPEN:
        opened_ = started_;
        break;
      case UHID_CLOSE:
        opened_ = false;
        break;
      case UHID_OUTPUT:
        if (started_) output({event.u.output.data, std::min<std::size_t>(event.u.output.size, UHID_DATA_MAX)});
        break;
      case UHID_GET_REPORT: {
        uhid_event reply{};
        reply.type = UHID_GET_REPORT_REPLY;
        reply.u.get_report_reply.id = event.u.get_report.id;
        reply.u.get_report_reply.err = EIO;
        (void)hand_over(fd_, reply);
        break;
      }
      case UHID_SET_REPORT: {
        uhid_event reply{};
        reply.type = UHID_SET_REPORT_REPLY;
        reply.u.set_report_reply.id = event.u.set_report.id;
        reply.u.set_report_reply.err = EIO;
        (void)hand_over(fd_, reply);
        break;
      }
      default:
        break;
    }
    return true;
  }
  bool send(std::span<const std::uint8_t> report) noexcept override {
    if (!opened_) return false;
    uhid_event event;  // NOLINT(cppcoreguidelines-pro-type-member-init): only what is used of its four kilobytes
    event.type = UHID_INPUT2;
    const std::size_t size = std::min<std::size_t>(report.size(), UHID_DATA_MAX);
    std::memcpy(event.u.input2.data, report.data(), size);
    event.u.input2.size = static_cast<std::uint16_t>(size);
    return hand_over(fd_, event, offsetof(uhid_event, u.input2.data) + size);
  }

 private:
  int fd_ = -1;
  bool plugged_ = false;
  bool started_ = false;  // the kernel has made the device that was plugged last
  bool opened_ = false;
};

struct Options {
  bool tracker = false, buttons = false, bus_powered = false;
  std::string serial;
  std::vector<std::string> fingers;
  double pulp_n_per_m = 1000;
  int rate_hz = 0;         // 0: the device's own
  std::string socket;      // served there instead of behind /dev/uhid
  bool inherited = false;  // or to the program that has the other end of file descriptor 3
  std::string memory, control, script, log;
  std::vector<std::string> timed;
};

jnd_finger finger_of(const std::string& name) {
  constexpr std::array<std::string_view, 6> kNames = {"any", "thumb", "index", "middle", "ring", "little"};
  const auto* const found = std::find(kNames.begin(), kNames.end(), name);
  if (found == kNames.end())
    throw InputError(fmt::format("--finger {}: give thumb, index, middle, ring, little or any", name));
  return static_cast<jnd_finger>(found - kNames.begin());
}

// The words after each --at, up to the next option, as one order: CLI11 would put those of two into one heap.
std::vector<std::string> join_timed(int argc, char** argv) {
  std::vector<std::string> arguments;
  for (int i = 1; i < argc; ++i) {
    arguments.emplace_back(argv[i]);
    if (arguments.back() != "--at") continue;
    std::string words;
    for (; i + 1 < argc && std::string_view(argv[i + 1]).substr(0, 2) != "--"; ++i)
      words += (words.empty() ? "" : " ") + std::string(argv[i + 1]);
    arguments.push_back(words);
  }
  return arguments;
}

void add_options(CLI::App& app, Options& options) {
  app.set_version_flag("--version", std::string("jnd-virtual-device ") + kVersion);
  auto* const tracker = app.add_flag("--tracker", options.tracker, "A tracker instead of a fingertip device");
  auto* const buttons = app.add_flag("--buttons", options.buttons, "A button box (a gamepad of 8 buttons) instead");
  buttons->excludes(tracker);
  auto* const socket =
      app.add_option("--socket", options.socket, "Serve it on a Unix socket at this path instead of behind /dev/uhid");
  socket->excludes(buttons);
  app.add_flag("--inherited", options.inherited,
               "Serve it on file descriptor 3: for the \"command\" of a rig file, which starts this program")
      ->excludes(buttons)
      ->excludes(socket);
  app.add_option("--serial", options.serial, "Serial number [VF-0001, VT-0001, VB-0001]");
  app.add_option("--finger", options.fingers,
                 "Finger that it is made for [index]; of a tracker, one or two [thumb index]");
  app.add_option("--pulp", options.pulp_n_per_m, "Stiffness of the finger's pulp, N/m")->capture_default_str();
  app.add_option("--rate", options.rate_hz, "Steps and reports a second [1000; of a tracker, of each finger, 200]");
  app.add_option("--memory", options.memory, "File that keeps what is stored in the device (its calibration)");
  app.add_flag("--bus-powered", options.bus_powered, "Unplugging takes the power away; otherwise the device runs on");
  app.add_option("--at", options.timed, "An order at a time in seconds since the start: --at 2.5 unplug 300");
  app.add_option("--script,--press-script", options.script, "File of such orders, one a line, the time first");
  app.add_option("--control", options.control, "Named pipe (made where missing) to read orders from [standard input]");
  app.add_option("--log", options.log, "File for every change of state, with its time and the force");
  app.footer("Orders:\n" + order_help() +
             "\nBehind /dev/uhid it needs Linux's module uhid, and to be root or a udev rule; on a socket nothing.\n"
             "Example:\n  jnd-virtual-device --socket thumb.sock --serial VF-0001 --finger thumb\n"
             "  sudo jnd-virtual-device --serial VF-0001 --finger thumb --at 10 unplug 500");
}

FaultScript script_of(const Options& options) {
  FaultScript script;
  for (const std::string& words : options.timed) script.add(parse_timed_order(words));
  if (options.script.empty()) return script;
  script.add_lines(read_input_file(options.script));
  return script;
}

std::unique_ptr<DevicePort> make_port(const Options& options) {
  if (options.inherited) return std::make_unique<SocketPort>(OwnedFile(kInheritedSocket));
  if (!options.socket.empty()) return std::make_unique<SocketPort>(std::filesystem::path(options.socket));
  return std::make_unique<UhidPort>();
}

std::unique_ptr<VirtualDevice> make_device(const Options& options, const std::unique_ptr<DevicePort>& port,
                                           EventLog& log) {
  const InputReport send = [&port](std::span<const std::uint8_t> report) { return port->send(report); };
  if (options.buttons)
    return std::make_unique<VirtualButtons>(options.serial.empty() ? "VB-0001" : options.serial, send);
  if (options.tracker) {
    TrackerOptions tracker;
    if (!options.serial.empty()) tracker.serial = options.serial;
    if (!options.fingers.empty()) tracker.fingers.clear();
    for (const std::string& finger : options.fingers) tracker.fingers.push_back(finger_of(finger));
    if (options.rate_hz != 0) tracker.rate_hz = options.rate_hz;
    return std::make_unique<VirtualTracker>(tracker, send);
  }
  FingertipOptions fingertip;
  if (!options.serial.empty()) fingertip.serial = options.serial;
  if (options.fingers.size() > 1) throw InputError("--finger: a fingertip device is made for one finger");
  if (!options.fingers.empty()) fingertip.finger = finger_of(options.fingers[0]);
  if (options.rate_hz != 0) fingertip.rate_hz = options.rate_hz;
  fingertip.pulp_n_per_m = options.pulp_n_per_m;
  fingertip.memory = options.memory;
  fingertip.bus_powered = options.bus_powered;
  return std::make_unique<VirtualFingertip>(fingertip, send, log);
}

int run(int argc, char** argv) {
  CLI::App app{"jnd-virtual-device: a fingertip device, tracker or button box behind /dev/uhid or on a socket",
               "jnd-virtual-device"};
  Options options;
  add_options(app, options);
  std::vector<std::string> arguments = join_timed(argc, argv);
  std::reverse(arguments.begin(), arguments.end());
  try {
    app.parse(arguments);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    FaultScript script = script_of(options);
    EventLog log = options.log.empty() ? EventLog() : EventLog(options.log);
    std::unique_ptr<DevicePort> port;  // after the device, so that wrong options are found on every machine
    const std::unique_ptr<VirtualDevice> device = make_device(options, port, log);
    port = make_port(options);
    ControlLines control(options.control);
    (void)::prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL, 0UL);
    (void)std::signal(SIGPIPE, SIG_IGN);
    DeviceLoop(*device, *port, script, control, log).run();
    return 0;
  } catch (const InputError& error) {
    fmt::print(stderr, "jnd-virtual-device: {}\n", error.what());
    return 3;
  } catch (const DeviceError& error) {
    fmt::print(stderr, "jnd-virtual-device: {}\n", error.what());
    return 4;
  }
}

}  // namespace
}  // namespace jnd

int main(int argc, char** argv) {
  return jnd::run(argc, argv);
}
