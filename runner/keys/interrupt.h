// Ctrl-C and other signals. A command that only computes ends at the first one, at once. One that writes, or moves a
// device, holds them: they set latches that it looks at, and nothing is ever killed in the middle of a write.
#pragma once

#include <atomic>

#include "devices/emergency_stop.h"

namespace jnd {

// What was asked for. Thread rule: any thread, and signal handlers.
struct Interrupts {
  std::atomic<bool> pause{false};  // a first Ctrl-C, in a session with an operator; until the pause is over
  std::atomic<bool> end{false};    // any other signal, or a second Ctrl-C
};

// Of this process.
Interrupts& interrupts() noexcept;
// interrupts().end: what everything but an operator's session looks at.
const std::atomic<bool>& interrupt_requested() noexcept;
// SIGINT, SIGTERM and SIGHUP. Without HoldInterrupts the first ends the program at once, with words and exit code 130.
// With it the first sets `end` and stop_requested() (analysis/numerics/stop_request.h), and a second one of the same
// kind ends the program at once, as usual.
// SIGXFSZ is ignored: a file that may not grow is trouble with storage, which is said where it is written.
void install_interrupt_handlers() noexcept;
void request_interrupt() noexcept;  // as if a signal had come
// From here on a write to a pipe without a reader fails, and does not end the program: for sessions, which have
// devices to bring to rest. Programs that are started from this one still end.
void outlive_readers() noexcept;

// While one lives, signals are latched: for work that has to be finished or undone.
class HoldInterrupts {
 public:
  HoldInterrupts() noexcept;
  ~HoldInterrupts();
  HoldInterrupts(const HoldInterrupts&) = delete;
  HoldInterrupts& operator=(const HoldInterrupts&) = delete;
};

// While it lives, a first Ctrl-C sets `pause` and a second one, whenever it comes before the pause is over, sets `end`;
// a third ends the program at once.
class PauseOnInterrupt {
 public:
  PauseOnInterrupt() noexcept;
  ~PauseOnInterrupt();
  PauseOnInterrupt(const PauseOnInterrupt&) = delete;
  PauseOnInterrupt& operator=(const PauseOnInterrupt&) = delete;
};
// The pause is over: the next Ctrl-C is a first one again.
void forget_pause() noexcept;

// While it lives, a signal also latches `stop`, so that a rig is stopped within two ticks.
class StopOnInterrupt {
 public:
  explicit StopOnInterrupt(EmergencyStop& stop) noexcept;
  ~StopOnInterrupt();
  StopOnInterrupt(const StopOnInterrupt&) = delete;
  StopOnInterrupt& operator=(const StopOnInterrupt&) = delete;
};

}  // namespace jnd
