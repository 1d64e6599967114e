#include "devices/machine/jitter_probe.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <thread>

#include "devices/loop/control_loop.h"

namespace jnd {

JitterReport probe_jitter(RealtimePolicy policy, double seconds, Clock& clock, const std::atomic<bool>& stop) {
  const RealtimeScope realtime(policy);
  JitterReport report;
  report.realtime = realtime.report();
  const auto periods =
      static_cast<std::int64_t>(std::llround(std::clamp(seconds, 0.0, 1e6) * 1e9 / static_cast<double>(kPeriod_ns)));
  const std::int64_t end_ns = clock.now_ns() + periods * kPeriod_ns;
  std::int64_t deadline_ns = end_ns - periods * kPeriod_ns;
  while (deadline_ns < end_ns && !stop.load(std::memory_order_relaxed)) {
    deadline_ns += kPeriod_ns;
    clock.sleep_until_ns(deadline_ns);
    const std::int64_t late_ns = std::max<std::int64_t>(clock.now_ns() - deadline_ns, 0);
    report.lateness.add(late_ns);
    ++report.ticks;
    // As the control loop: what was missed is counted and not caught up.
    const std::int64_t skipped = late_ns / kPeriod_ns;
    report.overruns += skipped;
    deadline_ns += skipped * kPeriod_ns;
  }
  return report;
}

JitterReport probe_jitter_on_thread(RealtimePolicy policy, double seconds, const std::atomic<bool>& stop) {
  JitterReport report;
  std::exception_ptr error;
  std::thread thread([&] {
    try {
      SteadyClock clock;
      report = probe_jitter(policy, seconds, clock, stop);
    } catch (...) {
      error = std::current_exception();
    }
  });
  thread.join();
  if (error) std::rethrow_exception(error);
  return report;
}

}  // namespace jnd
