// What happened to a virtual device and when: a JSON object a line, with the time on CLOCK_MONOTONIC in seconds. Tests
// judge watchdogs by it.
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace jnd {

class EventLog {
 public:
  EventLog() = default;  // keeps nothing
  // Throws DeviceError where the file cannot be written.
  explicit EventLog(const std::filesystem::path& file);

  // members: further JSON members without braces, or empty. Every line is handed to the system at once.
  void write(std::string_view event, std::string_view members);

 private:
  struct Close {
    void operator()(std::FILE* file) const noexcept { (void)std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Close> file_;
};

// CLOCK_MONOTONIC.
std::int64_t monotonic_ns() noexcept;

// A text as JSON writes it, with its quotes. Bytes beyond ASCII are passed through.
std::string json_text(std::string_view text);

}  // namespace jnd
