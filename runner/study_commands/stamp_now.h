// When something is done to a study outside its sessions.
#pragma once

#include "data/log/session_log.h"
#include "devices/clock.h"

namespace jnd {

// By this machine's clocks.
inline Stamp stamp_now() {
  const SteadyClock clock;
  return {clock.utc_ns(), clock.now_ns()};
}

}  // namespace jnd
