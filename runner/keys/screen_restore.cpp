#include "runner/keys/screen_restore.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <exception>

#include <unistd.h>

namespace jnd {

namespace {

// Written by the session's thread, read by handlers: `guarded` and `length` are set last and cleared first.
termios settings_of_shell;
std::array<char, 255> leave_screen;
std::atomic<int> length{0};
std::atomic<bool> guarded{false};
std::atomic<int> losses{0};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free);
std::terminate_handler terminate_before = nullptr;

// Whatever ends the program unless it is caught, but for the signals of interrupt.cpp.
constexpr std::array kCrashes = {SIGSEGV, SIGBUS,  SIGFPE,  SIGILL,  SIGABRT, SIGSYS,  SIGTRAP,
                                 SIGQUIT, SIGPIPE, SIGXCPU, SIGALRM, SIGUSR1, SIGUSR2, SIGVTALRM};

// SA_RESETHAND has put the signal's own way back: it ends the program, once this returns.
void on_crash(int signal_number) {
  restore_terminal();
  raise(signal_number);
}

void on_loss(int) {
  ++losses;
}

[[noreturn]] void on_terminate() {
  restore_terminal();  // before the message, which would vanish with the screen
  if (terminate_before != nullptr) terminate_before();
  std::abort();
}

void install_once() noexcept {
  static bool installed = false;
  if (installed) return;
  installed = true;
  // Where the stack is used up the handler needs another one.
  static std::array<char, 65536> handlers_stack;
  stack_t stack{};
  stack.ss_sp = handlers_stack.data();
  stack.ss_size = handlers_stack.size();
  sigaltstack(&stack, nullptr);
  struct sigaction crash {};
  crash.sa_handler = on_crash;
  crash.sa_flags = static_cast<int>(SA_RESETHAND | SA_ONSTACK);
  sigemptyset(&crash.sa_mask);
  for (const int signal_number : kCrashes) sigaction(signal_number, &crash, nullptr);
  struct sigaction loss {};
  loss.sa_handler = on_loss;
  loss.sa_flags = SA_RESTART;
  sigemptyset(&loss.sa_mask);
  for (const int signal_number : {SIGCONT, SIGWINCH}) sigaction(signal_number, &loss, nullptr);
  terminate_before = std::set_terminate(on_terminate);
  std::atexit(restore_terminal);
}

}  // namespace

void guard_terminal(const termios& settings) noexcept {
  settings_of_shell = settings;
  guarded = true;
  install_once();
  std::signal(SIGTSTP, SIG_IGN);
}

void forget_terminal() noexcept {
  if (guarded.exchange(false)) std::signal(SIGTSTP, SIG_DFL);
}

void guard_screen(std::string_view leave) noexcept {
  length = 0;
  const std::size_t copied = std::min(leave.size(), leave_screen.size());
  std::copy_n(leave.begin(), copied, leave_screen.begin());
  length = static_cast<int>(copied);
}

void restore_terminal() noexcept {
  const int errno_before = errno;
  const int count = length.exchange(0);
  if (count > 0) {
    [[maybe_unused]] const ssize_t written = write(STDOUT_FILENO, leave_screen.data(), static_cast<std::size_t>(count));
  }
  if (guarded) tcsetattr(STDIN_FILENO, TCSANOW, &settings_of_shell);
  errno = errno_before;
}

int terminal_losses() noexcept {
  return losses;
}

}  // namespace jnd
