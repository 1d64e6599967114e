#include "runner/keys/interrupt.h"

#include <csignal>

#include <unistd.h>

#include "analysis/numerics/stop_request.h"
#include "runner/keys/screen_restore.h"
#include "runner/terminal/exit_code.h"

namespace jnd {

namespace {

Interrupts latches;
std::atomic<bool> pausing{false};  // Ctrl-C pauses a session
std::atomic<int> presses{0};       // of Ctrl-C since the last pause was over
std::atomic<int> holds{0};         // HoldInterrupts that live
std::atomic<EmergencyStop*> rig_stop{nullptr};
// A signal handler may touch lock-free atomics only.
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free &&
              std::atomic<EmergencyStop*>::is_always_lock_free);

// The next signal of its kind ends the program at once, and leaves a usable terminal behind.
void end_at_once(int signal_number) {
  restore_terminal();
  struct sigaction standard {};
  standard.sa_handler = SIG_DFL;
  sigaction(signal_number, &standard, nullptr);
  raise(signal_number);
}

void end_at_next(int signal_number) {
  struct sigaction next {};
  next.sa_handler = end_at_once;
  sigaction(signal_number, &next, nullptr);
}

void latch_end() noexcept {
  latches.end = true;
  stop_requested() = true;
}

// Nothing would have to be finished or undone.
[[noreturn]] void end_with_words() noexcept {
  restore_terminal();
  constexpr char kWords[] = "\njnd: interrupted before it was done\n";
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, kWords, sizeof kWords - 1);
  _exit(exit_code::kInterrupted);
}

void on_signal(int signal_number) {
  const bool pauses = signal_number == SIGINT && pausing;
  if (pauses && presses.fetch_add(1) == 0) {
    latches.pause = true;
  } else {
    if (holds == 0) end_with_words();
    latch_end();
    end_at_next(signal_number);
  }
  if (EmergencyStop* stop = rig_stop) stop->latch(StopSource::signal);
}

}  // namespace

Interrupts& interrupts() noexcept {
  return latches;
}

const std::atomic<bool>& interrupt_requested() noexcept {
  return latches.end;
}

void request_interrupt() noexcept {
  latch_end();
}

void outlive_readers() noexcept {
  struct sigaction nothing {};
  nothing.sa_handler = [](int) {};  // unlike SIG_IGN not handed on
  nothing.sa_flags = SA_RESTART;
  sigemptyset(&nothing.sa_mask);
  sigaction(SIGPIPE, &nothing, nullptr);
}

HoldInterrupts::HoldInterrupts() noexcept {
  ++holds;
}
HoldInterrupts::~HoldInterrupts() {
  --holds;
}

void install_interrupt_handlers() noexcept {
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  for (const int signal_number : {SIGINT, SIGTERM, SIGHUP}) sigaction(signal_number, &action, nullptr);
  std::signal(SIGXFSZ, SIG_IGN);
}

PauseOnInterrupt::PauseOnInterrupt() noexcept {
  presses = 0;
  pausing = true;
}
PauseOnInterrupt::~PauseOnInterrupt() {
  pausing = false;
}

void forget_pause() noexcept {
  latches.pause = false;
  presses = 0;
}

StopOnInterrupt::StopOnInterrupt(EmergencyStop& stop) noexcept {
  rig_stop = &stop;
}
StopOnInterrupt::~StopOnInterrupt() {
  rig_stop = nullptr;
}

}  // namespace jnd
