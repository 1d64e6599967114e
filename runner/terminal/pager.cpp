#include "runner/terminal/pager.h"

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include "runner/terminal/other_programs.h"
#include "runner/terminal/terminal.h"

namespace jnd {

namespace {

constexpr int kNotStarted = 126, kNotFound = 127;  // what a shell ends with where it could not run the command

std::string environment(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? std::string() : value;
}

// Empty for none.
std::string pager() {
  for (const char* const name : {"JND_PAGER", "PAGER"})
    if (std::getenv(name) != nullptr) return environment(name) == "cat" ? std::string() : environment(name);
  return is_on_path("less") ? "less" : "";
}

bool longer_than_terminal(const std::string& text) {
  return std::count(text.begin(), text.end(), '\n') >= terminal_rows();
}

// While one lives, Ctrl-C is the pager's, and a pager that has ended is no signal.
class LeaveSignalsToPager {
 public:
  LeaveSignalsToPager() {
    struct sigaction ignored {};
    ignored.sa_handler = SIG_IGN;
    for (std::size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], &ignored, &before_[i]);
  }
  ~LeaveSignalsToPager() {
    for (std::size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], &before_[i], nullptr);
  }
  LeaveSignalsToPager(const LeaveSignalsToPager&) = delete;
  LeaveSignalsToPager& operator=(const LeaveSignalsToPager&) = delete;

 private:
  static constexpr std::array kSignals = {SIGPIPE, SIGINT};
  std::array<struct sigaction, kSignals.size()> before_{};
};

// False where it was not shown.
bool shown_by(const std::string& command, const std::string& text) {
  std::fflush(stdout);
  // For a less that the user names: with colours, and gone by itself where all fits.
  constexpr int kUnlessSet = 0;
  setenv("LESS", "FRX", kUnlessSet);
  // The user's own command, as git and man run it.
  std::FILE* const pipe = popen(command.c_str(), "w");  // NOLINT(cert-env33-c)
  if (pipe == nullptr) return false;
  const LeaveSignalsToPager signals;  // from here on: the pager itself obeys them
  std::fwrite(text.data(), 1, text.size(), pipe);
  const int status = pclose(pipe);
  return !(WIFEXITED(status) && (WEXITSTATUS(status) == kNotFound || WEXITSTATUS(status) == kNotStarted));
}

}  // namespace

void print_paged(const std::string& text) {
  if (is_terminal(STDOUT_FILENO) && longer_than_terminal(text))
    if (const std::string command = pager(); !command.empty() && shown_by(command, text)) return;
  fmt::print("{}", text);
}

}  // namespace jnd
