// A program that serves a device to this one, which started it: its end, and what it says on its standard error.
#pragma once

#include <filesystem>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "devices/hid/socket/local_socket.h"
#include "devices/machine/child_process.h"

namespace jnd {

// Thread rule: any thread.
class ServedProgram {
 public:
  // Starts it in that folder (empty: here). socket: its end, which becomes its file descriptor 3. Throws DeviceError.
  ServedProgram(const std::vector<std::string>& command, const std::filesystem::path& folder, const OwnedFile& socket);

  // Reads what it says, so that it never waits for a reader; the last line is kept.
  void hear() noexcept;
  bool has_exited() const noexcept;
  // Its connection is closed: ends it where it does not end by itself. "has ended (exit code 3)".
  std::string end();
  // ", and said last: ..."; empty where it said nothing. It may name the stimulus.
  std::string said() const;

 private:
  void keep(std::string_view text);

  mutable std::mutex mutex_;
  ChildProcess child_;
  std::string line_, last_line_;
};

}  // namespace jnd
