// The bytes to and from an external rig: a child process's standard streams, or a socket of this machine.
#pragma once

#include <array>
#include <chrono>
#include <memory>
#include <string>
#include <string_view>

#include "devices/external/external_settings.h"
#include "devices/external/rig_messages.h"
#include "devices/machine/child_process.h"
#include "devices/machine/line_cutter.h"

namespace jnd {

// Thread rule: one thread, whose SIGPIPE is blocked.
class RigConnection {
 public:
  // Starts the program, or connects. Throws DeviceError.
  explicit RigConnection(const ExternalSettings& settings);
  ~RigConnection();
  RigConnection(const RigConnection&) = delete;
  RigConnection& operator=(const RigConnection&) = delete;

  // Waits until there is something to read, `wake` (a file) is readable, or so many milliseconds are over.
  void wait(int wake, int milliseconds) const;
  // Reads what is there, at most 64 KiB, and hears its lines: whole(std::string_view), too_long(std::string_view).
  // Whether anything was there.
  template <typename Whole, typename TooLong>
  bool read(const Whole& whole, const TooLong& too_long) {
    const std::string_view bytes = read_bytes();
    lines_.cut(bytes, whole, [&] { too_long(lines_.rest()); });
    read_errors();
    return !bytes.empty();
  }
  bool is_open() const noexcept { return open_; }  // the rig has not closed its side
  // Writes what can be written without waiting, and keeps the rest. False where the rig has closed its side.
  bool write(std::string_view bytes);

  // Ends the program with everything that it started in its session, or closes the socket. Returns how it ended.
  std::string end(std::chrono::milliseconds grace);
  // Its input is over: of a socket, this side of it.
  void close_input() noexcept;
  // Lets it end by itself for so long. Whether it did; of a socket: whether it closed its side.
  bool leave(std::chrono::milliseconds patience);
  bool has_exited() const noexcept { return child_ != nullptr ? child_->has_exited() : !open_; }
  // The last line on its standard error, as printable ASCII.
  const std::string& last_error() const noexcept { return last_error_; }

 private:
  static constexpr std::size_t kLongestErrorLine = 512;

  std::string_view read_bytes();
  void read_errors();
  int reading() const noexcept { return child_ != nullptr ? child_->output() : socket_; }

  std::unique_ptr<ChildProcess> child_;  // null for a socket
  int socket_ = -1;
  bool open_ = true, errors_open_ = true;
  std::string unwritten_;
  LineCutter<kLongestRigLine> lines_;
  LineCutter<kLongestErrorLine> error_lines_;
  std::array<char, 65536> buffer_;
  std::string last_error_;
};

}  // namespace jnd
