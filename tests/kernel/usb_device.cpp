// A fingertip device on a USB bus of software (configfs HID gadget on dummy_hcd), which can stop reading: its host's
// writes then block for 5 s each, which no device behind /dev/uhid can show. It answers pages, follows the states, and
// streams telemetry; it has no platform and gives no force.
//
//   usb_device SERIAL STALL_AFTER_S STALL_S LIFE_S
//
// Root in a guest only. At its end it prints what it sent and received, as JSON.
#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <fcntl.h>
#include <poll.h>
#include <time.h>
#include <unistd.h>

#include "devices/hid/firmware/jnd_fingertip.h"
#include "devices/hid/firmware/jnd_report.h"

namespace {

namespace fs = std::filesystem;

const fs::path kGadget = "/sys/kernel/config/usb_gadget/fingertip";

// devices/hid/PROTOCOL.md, "Report descriptor of a fingertip device".
constexpr std::array<std::uint8_t, 41> kDescriptor = {0x06, 0x4A, 0xFF, 0x09, 0x01, 0xA1, 0x01, 0x15, 0x00, 0x26, 0xFF,
                                                      0x00, 0x75, 0x08, 0x95, 0x3F, 0x85, 0x01, 0x09, 0x01, 0x91, 0x02,
                                                      0x85, 0x02, 0x09, 0x02, 0x91, 0x02, 0x85, 0x11, 0x09, 0x11, 0x81,
                                                      0x02, 0x85, 0x12, 0x09, 0x12, 0x81, 0x02, 0xC0};

[[noreturn]] void fail(const std::string& what) {
  std::fprintf(stderr, "usb_device: %s: %s\n", what.c_str(), std::strerror(errno));
  std::exit(1);
}

void put(const fs::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  out << text << std::flush;
  if (!out) fail(file.string());
}

double now_s() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

int plug_in(const std::string& serial) {
  const fs::path function = kGadget / "functions/hid.usb0", config = kGadget / "configs/c.1";
  fs::create_directory(kGadget);
  fs::create_directory(kGadget / "strings/0x409");
  fs::create_directory(function);
  fs::create_directory(config);
  put(kGadget / "idVendor", "0x1209");
  put(kGadget / "idProduct", "0x5AFE");
  put(kGadget / "bcdUSB", "0x0200");
  put(kGadget / "strings/0x409/serialnumber", serial);
  put(kGadget / "strings/0x409/product", "Fingertip device on a bus of software");
  put(function / "protocol", "0");
  put(function / "subclass", "0");
  put(function / "report_length", "72");  // above 64, so that no report is followed by an empty packet
  put(function / "report_desc", std::string(kDescriptor.begin(), kDescriptor.end()));
  fs::create_symlink(function, config / "hid.usb0");
  put(kGadget / "UDC", "dummy_udc.0\n");
  for (int tries = 0; tries < 200; ++tries) {
    const int file = open("/dev/hidg0", O_RDWR | O_CLOEXEC | O_NONBLOCK);
    if (file >= 0) return file;
    usleep(10'000);
  }
  fail("/dev/hidg0");
}

class Device {
 public:
  Device(int file, const std::string& serial)
      : file_(file), config_(jnd_fingertip_default_config(serial.c_str(), JND_FINGER_ANY)), began_s_(now_s()) {}

  void take_report() {
    std::array<std::uint8_t, JND_REPORT_SIZE> bytes{};
    const ssize_t count = read(file_, bytes.data(), bytes.size());
    if (count <= 0) return;
    jnd_command command{};
    jnd_request request{};
    if (jnd_decode_command(bytes.data(), static_cast<std::size_t>(count), &command) == JND_DECODE_OK) {
      ++commands;
      last_command_ = command.sequence;
      active_ = command.mode != JND_MODE_REST;
      arrived_us_ = time_us();
    } else if (jnd_decode_request(bytes.data(), static_cast<std::size_t>(count), &request) == JND_DECODE_OK) {
      answer(request);
    } else {
      ++refused;
    }
  }

  void tell() {
    if (active_ && time_us() - arrived_us_ > 1000U * config_.identity.watchdog_ms) {
      active_ = false;
      stopped_ = true;
      ++watchdogs;
    }
    if (active_) stopped_ = false;
    jnd_telemetry telemetry{};
    telemetry.state = static_cast<std::uint8_t>(stopped_  ? JND_STATE_STOPPED
                                                : active_ ? JND_STATE_ACTIVE
                                                          : JND_STATE_REST);
    telemetry.faults = stopped_ ? JND_FAULT_WATCHDOG : 0;
    telemetry.sequence = ++sequence_;
    telemetry.command_sequence = last_command_;
    telemetry.time_us = time_us();
    const auto none = std::uint64_t{JND_COMMAND_AGE_NONE};
    telemetry.command_age_us = static_cast<std::uint16_t>(std::min(time_us() - arrived_us_, none));
    telemetry.height_nm = config_.geometry.rest_height_nm;
    telemetry.temperature_cdeg = JND_TEMPERATURE_NONE;
    telemetry.battery_percent = JND_BATTERY_NONE;
    std::array<std::uint8_t, JND_REPORT_SIZE> bytes{};
    jnd_encode_telemetry(&telemetry, bytes.data());
    if (write(file_, bytes.data(), bytes.size()) == JND_REPORT_SIZE) ++sent;
  }

  long commands = 0, refused = 0, sent = 0, watchdogs = 0;

 private:
  std::uint64_t time_us() const { return static_cast<std::uint64_t>((now_s() - began_s_) * 1e6); }

  void answer(const jnd_request& request) {
    jnd_answer answer{};
    answer.page = request.page;
    answer.token = request.token;
    if (request.operation != JND_READ_PAGE)
      answer.result = JND_PAGE_REFUSED;
    else if (request.page == JND_PAGE_IDENTITY)
      jnd_encode_identity(&config_.identity, answer.data);
    else if (request.page == JND_PAGE_LIMITS)
      jnd_encode_limits(&config_.limits, answer.data);
    else if (request.page == JND_PAGE_GEOMETRY)
      jnd_encode_geometry(&config_.geometry, answer.data);
    else if (request.page > JND_PAGE_CERTIFICATE)
      answer.result = JND_PAGE_UNKNOWN;
    std::array<std::uint8_t, JND_REPORT_SIZE> bytes{};
    jnd_encode_answer(&answer, bytes.data());
    // An answer may meet a full queue: telemetry goes out in between.
    for (int tries = 0; tries < 50 && write(file_, bytes.data(), bytes.size()) != JND_REPORT_SIZE; ++tries)
      usleep(1000);
  }

  int file_;
  jnd_fingertip_config config_;
  double began_s_;
  bool active_ = false, stopped_ = false;
  std::uint32_t sequence_ = 0, last_command_ = 0;
  std::uint64_t arrived_us_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) {
    std::fputs("usage: usb_device SERIAL STALL_AFTER_S STALL_S LIFE_S\n", stderr);
    return 2;
  }
  const double stall_after_s = std::atof(argv[2]), stall_s = std::atof(argv[3]), life_s = std::atof(argv[4]);
  const int file = plug_in(argv[1]);
  Device device(file, argv[1]);
  const double began_s = now_s();
  double next_s = began_s;
  double active_since_s = 0;  // the first command: the stall is timed from there
  long during_stall = 0;
  for (double at_s = began_s; at_s < began_s + life_s; at_s = now_s()) {
    if (active_since_s == 0 && device.commands > 0) active_since_s = at_s;
    const bool stalls =
        active_since_s > 0 && at_s > active_since_s + stall_after_s && at_s < active_since_s + stall_after_s + stall_s;
    pollfd wait{file, POLLIN, 0};
    const double left_s = next_s - at_s;
    if (stalls)
      usleep(left_s > 0 ? static_cast<useconds_t>(left_s * 1e6) : 0);
    else if (poll(&wait, 1, left_s > 0 ? static_cast<int>(left_s * 1e3) + 1 : 0) > 0 && (wait.revents & POLLIN) != 0)
      device.take_report();
    if (now_s() < next_s) continue;
    next_s += 0.002;
    const long before = device.sent;
    device.tell();
    if (stalls) during_stall += device.sent - before;
  }
  std::printf("{\"commands\": %ld, \"refused\": %ld, \"sent\": %ld, \"sent_during_stall\": %ld, \"watchdogs\": %ld}\n",
              device.commands, device.refused, device.sent, during_stall, device.watchdogs);
  put(kGadget / "UDC", "\n");
  return 0;
}
