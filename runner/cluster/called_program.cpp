#include "runner/cluster/called_program.h"

#include <cerrno>
#include <csignal>
#include <cstdio>

#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "devices/machine/child_process.h"
#include "protocols/input/number_from.h"

namespace jnd {

namespace {

constexpr int kLook_ms = 50;
constexpr std::size_t kMostBytes = std::size_t{64} << 20U;  // that it prints: a queue of millions of tasks

// Appends what can be read now. False at the end of the stream.
bool read_some(int file, std::string& to) {
  char bytes[4096];
  const ssize_t count = read(file, bytes, sizeof bytes);
  if (count > 0) to.append(bytes, static_cast<std::size_t>(count));
  return count > 0 || (count < 0 && (errno == EAGAIN || errno == EINTR));
}

std::string trimmed(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  return text;
}

}  // namespace

std::string CalledProgram::trouble() const {
  std::string words = trimmed(errors.empty() ? output : errors);
  if (!words.empty()) return words;
  return code ? fmt::format("exit code {}", *code) : "it was ended";
}

CalledProgram call_program(const std::vector<std::string>& command, const std::filesystem::path& folder,
                           const std::function<bool()>& keep_waiting) {
  ChildProcess child(command, folder);
  CalledProgram called;
  bool output = true, errors = true;
  const auto endless = [&] { return called.output.size() + called.errors.size() > kMostBytes; };
  while ((output || errors) && !endless() && keep_waiting()) {
    pollfd files[2] = {{output ? child.output() : -1, POLLIN, 0}, {errors ? child.errors() : -1, POLLIN, 0}};
    if (poll(files, 2, kLook_ms) <= 0) continue;
    if (files[0].revents != 0) output = read_some(child.output(), called.output);
    if (files[1].revents != 0) errors = read_some(child.errors(), called.errors);
  }
  // The streams may end before the program does.
  while (!endless() && !child.has_exited() && keep_waiting()) usleep(1000);
  const bool exited = child.has_exited();
  const std::string how = child.end();
  constexpr std::string_view kCode = "exit code ";
  if (exited && how.starts_with(kCode)) {
    const std::string rest = how.substr(kCode.size());
    called.code = number_from<int>(rest.substr(0, rest.find(':')));
  }
  called.done = called.code == 0;
  if (endless()) {
    called.output.clear();
    called.errors = fmt::format("it printed more than {} MB", kMostBytes >> 20U);
  }
  return called;
}

int run_program(const std::vector<std::string>& command, const std::filesystem::path& folder) {
  std::vector<std::string> words = command;
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  std::fflush(stdout);
  posix_spawn_file_actions_t files{};
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addchdir_np(&files, folder.c_str());
  posix_spawn_file_actions_addclosefrom_np(&files, STDERR_FILENO + 1);
  posix_spawnattr_t attributes{};
  posix_spawnattr_init(&attributes);
  sigset_t all;
  sigfillset(&all);
  posix_spawnattr_setsigdefault(&attributes, &all);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);
  pid_t child = -1;
  const int error = posix_spawnp(&child, arguments[0], &files, &attributes, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  posix_spawnattr_destroy(&attributes);
  if (error != 0) return 127;
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace jnd
