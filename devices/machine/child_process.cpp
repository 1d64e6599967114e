#include "devices/machine/child_process.h"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <sstream>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "devices/device_error.h"
#include "protocols/input/number_from.h"

namespace jnd {

namespace {

constexpr std::chrono::milliseconds kLookEvery{5};
constexpr int kMostLooks = 40;  // at what is left of a session that is being killed

void close_end(int& end) noexcept {
  if (end >= 0) close(end);
  end = -1;
}

// Both ends of a pipe, closed with it unless taken.
struct Pipe {
  Pipe() {
    if (pipe2(ends, O_CLOEXEC) != 0) throw DeviceError(fmt::format("no pipe can be made: {}", std::strerror(errno)));
  }
  ~Pipe() {
    for (int& end : ends) close_end(end);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  int take(int end) {
    (void)fcntl(ends[end], F_SETFL, O_NONBLOCK);
    return std::exchange(ends[end], -1);
  }

  int ends[2] = {-1, -1};  // for reading, for writing
};

// What the child does before it becomes the program: only calls that a signal handler may make, because other threads
// of this program may have held locks when it was forked.
struct ChildStart {
  char* const* arguments;
  const char* folder;  // null: here
  int input, output, errors;
  int inherited;  // becomes its file descriptor 3; below 0: none
  int failure;    // where errno is written if the program cannot be started
  pid_t parent;

  [[noreturn]] void become_program() const noexcept {
    (void)setsid();
    // A parent that died before this call is not noticed by it.
    if (prctl(PR_SET_PDEATHSIG, SIGKILL) != 0 || getppid() != parent) fail();
    reset_signals();
    // Out of the way of what they are moved over.
    const int passed_on = inherited >= 0 ? fcntl(inherited, F_DUPFD_CLOEXEC, kFirstFree) : -1;
    const int told = fcntl(failure, F_DUPFD_CLOEXEC, kFirstFree);
    if (told < 0 || (inherited >= 0 && passed_on < 0)) fail();
    if (dup2(input, STDIN_FILENO) < 0 || dup2(output, STDOUT_FILENO) < 0 || dup2(errors, STDERR_FILENO) < 0) fail();
    if (folder != nullptr && chdir(folder) != 0) fail();
    (void)close(kInherited);
    if (passed_on >= 0 && dup2(passed_on, kInherited) < 0) fail(told);
    // The end of the failure pipe must stay open until exec closes it.
    (void)dup3(told, kFailure, O_CLOEXEC);
    (void)close_range(kFailure + 1, ~0U, 0);
    (void)execvp(arguments[0], arguments);
    fail(kFailure);
  }

 private:
  static constexpr int kInherited = STDERR_FILENO + 1, kFailure = kInherited + 1, kFirstFree = 10;

  static void reset_signals() noexcept {
    struct sigaction usual {};
    usual.sa_handler = SIG_DFL;
    for (int signal = 1; signal < NSIG; ++signal) (void)sigaction(signal, &usual, nullptr);
    sigset_t none;
    sigemptyset(&none);
    (void)sigprocmask(SIG_SETMASK, &none, nullptr);
  }
  [[noreturn]] void fail() const noexcept { fail(failure); }
  [[noreturn]] static void fail(int file) noexcept {
    const int error = errno;
    (void)!write(file, &error, sizeof error);
    _exit(127);
  }
};

std::string how_it_ended(const siginfo_t& info) {
  if (info.si_code == CLD_EXITED)
    return fmt::format("exit code {}{}", info.si_status, info.si_status == 127 ? ": a program was not found" : "");
  return fmt::format("signal {} ({})", info.si_status, strsignal(info.si_status));  // NOLINT(concurrency-mt-unsafe)
}

void reap(pid_t pid, siginfo_t& info) noexcept {
  while (waitid(P_PID, static_cast<id_t>(pid), &info, WEXITED) != 0 && errno == EINTR) {
  }
}

// Whether the process of /proc/NUMBER lives in this session.
bool lives_in(const std::filesystem::path& entry, pid_t session) {
  std::ifstream file(entry / "stat");
  std::string stat;
  std::getline(file, stat, '\0');  // a process that goes meanwhile is a read that fails, which this takes for an end
  const std::size_t name_end = stat.rfind(')');  // a name may have blanks and brackets
  if (name_end == std::string::npos) return false;
  std::istringstream fields(stat.substr(name_end + 1));
  char state = 0;
  pid_t parent = 0, group = 0, its_session = 0;
  fields >> state >> parent >> group >> its_session;
  return its_session == session && state != 'Z' && state != 'X';
}

// SIGKILL to what lives in a session, whatever groups it made there. Returns how many there were.
int kill_session(pid_t session) {
  int found = 0;
  std::error_code error;
  for (std::filesystem::directory_iterator entry("/proc", error), end; !error && entry != end; entry.increment(error)) {
    const auto pid = number_from<pid_t>(entry->path().filename().string());
    if (!pid || !lives_in(entry->path(), session)) continue;
    (void)kill(*pid, SIGKILL);
    ++found;
  }
  return found;
}

}  // namespace

ChildProcess::ChildProcess(const std::vector<std::string>& command, const std::filesystem::path& folder,
                           ChildInput input, int inherited) {
  if (command.empty()) throw DeviceError("no program is named");
  Pipe source, output, errors, failure;
  if (input == ChildInput::none) close_end(source.ends[1]);  // it reads the end of a file at once
  std::vector<std::string> words = command;
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const ChildStart start{.arguments = arguments.data(),
                         .folder = folder.empty() ? nullptr : folder.c_str(),
                         .input = source.ends[0],
                         .output = output.ends[1],
                         .errors = errors.ends[1],
                         .inherited = inherited,
                         .failure = failure.ends[1],
                         .parent = getpid()};
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);  // no handler of this program runs in the child
  pid_ = fork();
  if (pid_ == 0) start.become_program();
  const int fork_error = errno;
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  if (pid_ < 0) throw DeviceError(fmt::format("cannot be started: {}", std::strerror(fork_error)));
  close_end(failure.ends[1]);
  int error = 0;
  ssize_t count = 0;
  do count = read(failure.ends[0], &error, sizeof error);
  while (count < 0 && errno == EINTR);
  if (count > 0) {
    siginfo_t info{};
    reap(std::exchange(pid_, -1), info);
    throw DeviceError(fmt::format("cannot be started: {}", std::strerror(error)));
  }
  output_ = output.take(0);
  errors_ = errors.take(0);
  if (input == ChildInput::pipe) input_ = source.take(1);
}

ChildProcess::~ChildProcess() {
  (void)end();
}

void ChildProcess::close_input() noexcept {
  close_end(input_);
}

bool ChildProcess::has_exited() const noexcept {
  if (pid_ < 0) return true;
  siginfo_t info{};
  // It is left a zombie, so that its number stays its own until the group has been ended.
  const int result = waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT);
  return result != 0 || info.si_pid == pid_;
}

std::string ChildProcess::end(std::chrono::milliseconds grace) {
  if (pid_ < 0) return how_;
  close_input();
  if (!has_exited()) {
    (void)kill(-pid_, SIGTERM);
    const auto patience = std::chrono::steady_clock::now() + grace;
    while (!has_exited() && std::chrono::steady_clock::now() < patience) std::this_thread::sleep_for(kLookEvery);
  }
  (void)kill(-pid_, SIGKILL);
  // The zombie still holds the session's number, so that no other session can have it.
  for (int look = 0; look < kMostLooks && kill_session(pid_) > 0; ++look) std::this_thread::sleep_for(kLookEvery);
  siginfo_t info{};
  reap(pid_, info);
  how_ = how_it_ended(info);
  pid_ = -1;
  close_end(output_);
  close_end(errors_);
  return how_;
}

}  // namespace jnd
