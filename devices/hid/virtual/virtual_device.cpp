#include "devices/hid/virtual/virtual_device.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <utility>

#include <fmt/format.h>

#include "devices/device_error.h"

namespace jnd {

namespace {

using Report = std::array<std::uint8_t, JND_REPORT_SIZE>;

constexpr std::uint8_t kOtherVersion = 9;
constexpr std::size_t kCrcAt = JND_REPORT_SIZE - 4;

Report copy_of(std::span<const std::uint8_t, JND_REPORT_SIZE> report) noexcept {
  Report copy{};
  std::copy(report.begin(), report.end(), copy.begin());
  return copy;
}

constexpr std::uint8_t kInput = 0x81, kOutput = 0x91;

struct NumberedReport {
  std::uint8_t id, item;
};

std::vector<std::uint8_t> vendor_descriptor(std::uint8_t usage, const std::vector<NumberedReport>& reports) {
  std::vector<std::uint8_t> bytes = {
      0x06,
      JND_USAGE_PAGE & 0xFF,
      JND_USAGE_PAGE >> 8,  // Usage Page (vendor)
      0x09,
      usage,  // Usage
      0xA1,
      0x01,  // Collection (Application)
      0x15,
      0x00,  // Logical Minimum (0)
      0x26,
      0xFF,
      0x00,  // Logical Maximum (255)
      0x75,
      0x08,  // Report Size (8)
      0x95,
      JND_REPORT_SIZE - 1,  // Report Count (63)
  };
  for (const NumberedReport& report : reports)  // Report ID, Usage, Input or Output (Data, Variable, Absolute)
    bytes.insert(bytes.end(), {0x85, report.id, 0x09, report.id, report.item, 0x02});
  bytes.push_back(0xC0);  // End Collection
  return bytes;
}

}  // namespace

EventLog::EventLog(const std::filesystem::path& file) : file_(std::fopen(file.c_str(), "we")) {
  if (!file_)
    throw DeviceError(fmt::format("cannot write the log {}: {}; give --log a file in a folder that you may write to",
                                  file.string(), std::strerror(errno)));
}

void EventLog::write(std::string_view event, std::string_view members) {
  if (!file_) return;
  const std::int64_t now_ns = monotonic_ns();
  fmt::print(file_.get(), "{{\"time_s\":{}.{:09},\"event\":\"{}\"{}{}}}\n", now_ns / 1'000'000'000,
             now_ns % 1'000'000'000, event, members.empty() ? "" : ",", members);
  (void)std::fflush(file_.get());
}

std::int64_t monotonic_ns() noexcept {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

std::string json_text(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (static_cast<unsigned char>(c) < 0x20)
      out += fmt::format("\\u{:04x}", static_cast<unsigned>(static_cast<unsigned char>(c)));
    else
      out += c;
  }
  return out + '"';
}

Report in_version(std::span<const std::uint8_t, JND_REPORT_SIZE> report, std::uint8_t version) noexcept {
  Report changed = copy_of(report);
  jnd_answer answer{};
  if (jnd_decode_answer(changed.data(), changed.size(), &answer) == JND_DECODE_OK && answer.page == JND_PAGE_IDENTITY &&
      answer.result == JND_PAGE_OK) {
    answer.data[0] = answer.data[1] = version;
    jnd_encode_answer(&answer, changed.data());
    return changed;
  }
  changed[1] = version;
  const std::uint32_t crc = jnd_crc32(changed.data(), kCrcAt);
  for (std::size_t byte = 0; byte < 4; ++byte)
    changed[kCrcAt + byte] = static_cast<std::uint8_t>((crc >> (8 * byte)) & 0xFFU);
  return changed;
}

ReportOutlet::ReportOutlet(std::uint8_t stream, InputReport port) : stream_(stream), port_(std::move(port)) {}

bool ReportOutlet::send(std::span<const std::uint8_t, JND_REPORT_SIZE> report) {
  Report out = wrong_version_ ? in_version(report, kOtherVersion) : copy_of(report);
  if (out[0] != stream_) {
    if (!port_(out)) return false;
    ++answered_;
    return true;
  }
  if (to_drop_ > 0) {
    --to_drop_;
    ++dropped_;
    return true;
  }
  const bool damages = to_damage_ > 0;
  if (damages) out[kCrcAt] = static_cast<std::uint8_t>(out[kCrcAt] ^ 0x55U);
  if (!port_(out)) return false;
  ++sent_;
  if (damages) {
    --to_damage_;
    ++damaged_;
  }
  return true;
}

bool ReportOutlet::obey(const DeviceOrder& order) noexcept {
  switch (order.kind) {
    case OrderKind::drop:
      to_drop_ = static_cast<std::int64_t>(order.amount);
      return true;
    case OrderKind::damage:
      to_damage_ = static_cast<std::int64_t>(order.amount);
      return true;
    case OrderKind::wrong_version:
      wrong_version_ = order.on;
      return true;
    default:
      return false;
  }
}

std::vector<std::uint8_t> fingertip_descriptor() {
  return vendor_descriptor(JND_USAGE_FINGERTIP, {{JND_REPORT_COMMAND, kOutput},
                                                 {JND_REPORT_REQUEST, kOutput},
                                                 {JND_REPORT_TELEMETRY, kInput},
                                                 {JND_REPORT_PAGE, kInput}});
}

std::vector<std::uint8_t> tracker_descriptor() {
  return vendor_descriptor(JND_USAGE_TRACKER,
                           {{JND_REPORT_REQUEST, kOutput}, {JND_REPORT_PAGE, kInput}, {JND_REPORT_TRACKER, kInput}});
}

std::vector<std::uint8_t> gamepad_descriptor() {
  return {
      0x05, 0x01,        // Usage Page (Generic Desktop)
      0x09, 0x05,        // Usage (Game Pad)
      0xA1, 0x01,        // Collection (Application)
      0x15, 0x00,        //   Logical Minimum (0)
      0x26, 0xFF, 0x00,  //   Logical Maximum (255)
      0x75, 0x08,        //   Report Size (8)
      0x95, 0x02,        //   Report Count (2)
      0x09, 0x30,        //   Usage (X)
      0x09, 0x31,        //   Usage (Y)
      0x81, 0x02,        //   Input (Data, Variable, Absolute)
      0x05, 0x09,        //   Usage Page (Button)
      0x19, 0x01,        //   Usage Minimum (1)
      0x29, 0x08,        //   Usage Maximum (8)
      0x25, 0x01,        //   Logical Maximum (1)
      0x75, 0x01,        //   Report Size (1)
      0x95, 0x08,        //   Report Count (8)
      0x81, 0x02,        //   Input (Data, Variable, Absolute)
      0xC0,              // End Collection
  };
}

}  // namespace jnd
