#include "runner/interrupt.h"

#include <csignal>

namespace jnd {

namespace {

std::atomic<bool> requested{false};
std::atomic<EmergencyStop*> rig_stop{nullptr};
// A signal handler may touch lock-free atomics only.
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<EmergencyStop*>::is_always_lock_free);

void on_signal(int signal_number) {
  requested = true;
  if (EmergencyStop* stop = rig_stop) stop->latch(StopSource::signal);
  struct sigaction standard {};
  standard.sa_handler = SIG_DFL;
  sigaction(signal_number, &standard, nullptr);
}

}  // namespace

const std::atomic<bool>& interrupt_requested() noexcept {
  return requested;
}

void request_interrupt() noexcept {
  requested = true;
}

void install_interrupt_handlers() noexcept {
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

StopOnInterrupt::StopOnInterrupt(EmergencyStop& stop) noexcept {
  rig_stop = &stop;
}
StopOnInterrupt::~StopOnInterrupt() {
  rig_stop = nullptr;
}

}  // namespace jnd
