// A program that this one starts, listens to, and ends.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <sys/types.h>

namespace jnd {

// The program gets a process group of its own, an empty standard input, the signals' default actions and none of this
// program's other files. Thread rule: one thread.
class ChildProcess {
 public:
  // Starts it, in `folder` (empty: here); a name without a slash is looked for along PATH. Throws DeviceError.
  ChildProcess(const std::vector<std::string>& command, const std::filesystem::path& folder);
  // As end().
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  // What can be read of its standard output and its standard error, without waiting.
  int output() const noexcept { return output_; }
  int errors() const noexcept { return errors_; }

  bool has_exited() const noexcept;
  // SIGTERM to the group, SIGKILL to what is left of it after a second; at once where it has exited. Leaves no zombie.
  // Returns how it ended, such as "exit code 1".
  std::string end();

 private:
  pid_t pid_ = -1;  // and of its group; -1: it is over
  int output_ = -1, errors_ = -1;
  std::string how_;
};

}  // namespace jnd
