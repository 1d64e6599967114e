// Ctrl-C and SIGTERM: a latch that the session and the rig look at. Nothing is ever killed in the middle of a write.
#pragma once

#include <atomic>

#include "devices/emergency_stop.h"

namespace jnd {

// The first signal sets the latches; a second one of the same kind ends the program at once, as usual.
const std::atomic<bool>& interrupt_requested() noexcept;
void install_interrupt_handlers() noexcept;
void request_interrupt() noexcept;  // as if Ctrl-C had been pressed

// While it lives, a signal also latches `stop`, so that a rig is stopped within two ticks.
class StopOnInterrupt {
 public:
  explicit StopOnInterrupt(EmergencyStop& stop) noexcept;
  ~StopOnInterrupt();
  StopOnInterrupt(const StopOnInterrupt&) = delete;
  StopOnInterrupt& operator=(const StopOnInterrupt&) = delete;
};

}  // namespace jnd
