#include "devices/trackers/child_process.h"

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "devices/device_error.h"

namespace jnd {

namespace {

constexpr std::chrono::milliseconds kGrace{1000};  // from SIGTERM to SIGKILL
constexpr std::chrono::milliseconds kLookEvery{5};

// Both ends of a pipe, closed with it unless taken.
struct Pipe {
  Pipe() {
    if (pipe2(ends, O_CLOEXEC) != 0) throw DeviceError(fmt::format("no pipe can be made: {}", std::strerror(errno)));
  }
  ~Pipe() {
    for (const int end : ends)
      if (end >= 0) close(end);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  int take_reading() {
    (void)fcntl(ends[0], F_SETFL, O_NONBLOCK);
    return std::exchange(ends[0], -1);
  }

  int ends[2] = {-1, -1};  // for reading, for writing
};

// What posix_spawn is told; its parts want to be freed.
struct SpawnPlan {
  SpawnPlan() {
    posix_spawn_file_actions_init(&files);
    posix_spawnattr_init(&attributes);
  }
  ~SpawnPlan() {
    posix_spawn_file_actions_destroy(&files);
    posix_spawnattr_destroy(&attributes);
  }
  SpawnPlan(const SpawnPlan&) = delete;
  SpawnPlan& operator=(const SpawnPlan&) = delete;

  posix_spawn_file_actions_t files{};
  posix_spawnattr_t attributes{};
};

std::string how_it_ended(const siginfo_t& info) {
  if (info.si_code == CLD_EXITED)
    return fmt::format("exit code {}{}", info.si_status, info.si_status == 127 ? ": a program was not found" : "");
  return fmt::format("signal {} ({})", info.si_status, strsignal(info.si_status));  // NOLINT(concurrency-mt-unsafe)
}

}  // namespace

ChildProcess::ChildProcess(const std::vector<std::string>& command, const std::filesystem::path& folder) {
  if (command.empty()) throw DeviceError("no program is named");
  Pipe output, errors;
  SpawnPlan plan;
  posix_spawn_file_actions_addopen(&plan.files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&plan.files, output.ends[1], STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&plan.files, errors.ends[1], STDERR_FILENO);
  posix_spawn_file_actions_addclosefrom_np(&plan.files, STDERR_FILENO + 1);
  if (!folder.empty()) posix_spawn_file_actions_addchdir_np(&plan.files, folder.c_str());
  sigset_t none, all;
  sigemptyset(&none);
  sigfillset(&all);
  posix_spawnattr_setsigmask(&plan.attributes, &none);
  posix_spawnattr_setsigdefault(&plan.attributes, &all);
  posix_spawnattr_setpgroup(&plan.attributes, 0);
  posix_spawnattr_setflags(&plan.attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  std::vector<std::string> words = command;
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const int error = posix_spawnp(&pid_, arguments[0], &plan.files, &plan.attributes, arguments.data(), environ);
  if (error != 0) {
    pid_ = -1;
    throw DeviceError(fmt::format("cannot be started: {}", std::strerror(error)));
  }
  output_ = output.take_reading();
  errors_ = errors.take_reading();
}

ChildProcess::~ChildProcess() {
  (void)end();
}

bool ChildProcess::has_exited() const noexcept {
  if (pid_ < 0) return true;
  siginfo_t info{};
  // It is left a zombie, so that its number stays its own until the group has been ended.
  const int result = waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT);
  return result != 0 || info.si_pid == pid_;
}

std::string ChildProcess::end() {
  if (pid_ < 0) return how_;
  if (!has_exited()) {
    (void)kill(-pid_, SIGTERM);
    const auto patience = std::chrono::steady_clock::now() + kGrace;
    while (!has_exited() && std::chrono::steady_clock::now() < patience) std::this_thread::sleep_for(kLookEvery);
  }
  (void)kill(-pid_, SIGKILL);
  siginfo_t info{};
  while (waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED) != 0 && errno == EINTR) {
  }
  how_ = how_it_ended(info);
  pid_ = -1;
  close(output_);
  close(errors_);
  output_ = errors_ = -1;
  return how_;
}

}  // namespace jnd
