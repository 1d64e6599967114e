// A program that this one starts, listens to, talks to, and ends.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include <sys/types.h>

namespace jnd {

enum class ChildInput { none, pipe };  // none: an empty standard input

// The program gets a session and process group of its own, the signals' default actions and none of this program's other
// files. It is killed when the thread that made this ends, so also where this whole program is killed. Thread rule: one
// thread.
class ChildProcess {
 public:
  // Starts it, in `folder` (empty: here); a name without a slash is looked for along PATH. inherited: an open file that
  // becomes its file descriptor 3; below 0: none. Throws DeviceError.
  ChildProcess(const std::vector<std::string>& command, const std::filesystem::path& folder,
               ChildInput input = ChildInput::none, int inherited = -1);
  // As end().
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  // What can be read of its standard output and its standard error, without waiting.
  int output() const noexcept { return output_; }
  int errors() const noexcept { return errors_; }
  // What its standard input can be written to, without waiting; -1 where it has none. A write to a program that is gone
  // is SIGPIPE: block it.
  int input() const noexcept { return input_; }
  void close_input() noexcept;

  bool has_exited() const noexcept;
  // SIGTERM to the group, SIGKILL to what is left of it and of its session after `grace`; at once where it has exited.
  // A descendant that made a session of its own is not found. Leaves no zombie. Returns how it ended, such as "exit code
  // 1".
  std::string end(std::chrono::milliseconds grace = std::chrono::milliseconds(1000));

 private:
  pid_t pid_ = -1;  // and of its group and session; -1: it is over
  int output_ = -1, errors_ = -1, input_ = -1;
  std::string how_;
};

}  // namespace jnd
