#include "devices/hid/virtual/event_log.h"

#include <cerrno>
#include <cstring>
#include <ctime>
#include <string>

#include <fmt/format.h>

#include "devices/device_error.h"

namespace jnd {

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

}  // namespace jnd
