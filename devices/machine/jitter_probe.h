// How punctually this machine wakes a thread: the loop's own waiting, on absolute deadlines, without a device.
#pragma once

#include <atomic>
#include <cstdint>

#include "devices/clock.h"
#include "devices/loop/lateness.h"
#include "devices/realtime.h"

namespace jnd {

struct JitterReport {
  RealtimeReport realtime;
  std::int64_t ticks = 0;     // wake-ups measured
  std::int64_t overruns = 0;  // whole periods of 1 ms skipped
  LatenessHistogram lateness;
};

// Wakes every millisecond (kPeriod_ns) for `seconds` (of the clock, > 0) on the calling thread, with the policy for
// that long; ends early where `stop` is set. Throws DeviceError under `require` where the machine refuses.
JitterReport probe_jitter(RealtimePolicy policy, double seconds, Clock& clock, const std::atomic<bool>& stop);

// The same on this machine's steady clock and on a thread of its own, as the loop of a session runs.
JitterReport probe_jitter_on_thread(RealtimePolicy policy, double seconds, const std::atomic<bool>& stop);

}  // namespace jnd
