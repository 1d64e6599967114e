// Another program that this one calls and waits for.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace jnd {

struct CalledProgram {
  bool done = false;           // exit code 0
  std::optional<int> code;     // none: it was ended, by a signal or because nobody waits any more
  std::string output, errors;  // what it printed

  // Why it did not do it, in its own words or else its exit code.
  std::string trouble() const;
};

// Runs it in `folder` and takes what it prints; it has no terminal, so that a Ctrl-C does not reach it. It is ended where
// keep_waiting() is false, or it prints without end. Throws DeviceError where it cannot be started.
CalledProgram call_program(const std::vector<std::string>& command, const std::filesystem::path& folder,
                           const std::function<bool()>& keep_waiting);

// Runs it in `folder` with this program's standard streams and returns its exit code; 127 where it cannot be started.
int run_program(const std::vector<std::string>& command, const std::filesystem::path& folder);

}  // namespace jnd
