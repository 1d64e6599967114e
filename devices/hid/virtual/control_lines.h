// Lines that come while the program runs: from its standard input, or from a named pipe or file.
//
// Thread rule: one thread. Nothing waits: fd() can be polled.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace jnd {

class ControlLines {
 public:
  // Empty: standard input. A path where there is nothing yet becomes a named pipe. Throws DeviceError where it cannot
  // be opened.
  explicit ControlLines(const std::filesystem::path& path);
  ~ControlLines();
  ControlLines(const ControlLines&) = delete;
  ControlLines& operator=(const ControlLines&) = delete;

  int fd() const noexcept { return fd_; }  // below 0: at its end, nothing comes any more
  // What can be read now; every whole line that is not blank goes to `line`.
  void serve(const std::function<void(std::string_view)>& line);

 private:
  int fd_ = -1;
  bool own_ = false;
  std::string rest_;  // of a line that is not whole yet
};

}  // namespace jnd
