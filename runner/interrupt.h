// Ctrl-C and other signals: latches that the session and the rig look at. Nothing is ever killed in the middle of a
// write.
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
// SIGINT, SIGTERM and SIGHUP. The first sets `end`, a second one of the same kind ends the program at once, as usual.
// SIGXFSZ is ignored: a file that may not grow is trouble with storage, which is said where it is written.
void install_interrupt_handlers() noexcept;
void request_interrupt() noexcept;  // as if a signal had come

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
