#include "devices/machine/rehearsal_probe.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "devices/clock.h"
#include "devices/machine/machine_checks.h"

namespace jnd {

RehearsalReport probe_rehearsal(Rig& rig, const Stimulus& stimulus, double seconds, const std::atomic<bool>& stop) {
  constexpr double kExplore_s = 0.5, kNoContact_s = 5;
  RehearsalReport report;
  report.realtime = rig.realtime();
  rig.watch([&](const LoopSnapshot&) {
    if (stop) rig.stop.latch(StopSource::program);
  });
  const SteadyClock clock;
  const std::int64_t end_ns = clock.now_ns() + static_cast<std::int64_t>(seconds * 1e9);
  do {
    PresentRequest request;
    request.stimulus = stimulus;
    request.explore_s = kExplore_s;
    request.no_contact_time_out_s = kNoContact_s;
    request.id.trial = report.presentations + 1;
    const Presentation given = rig.present(request);
    if (stop) break;
    ++report.presentations;
    report.presented_s += given.duration_s;
    report.ticks += given.ticks;
    report.overruns += given.overruns;
    report.p99_us = std::max(report.p99_us, given.lateness_p99_us);
    report.largest_us = std::max(report.largest_us, given.lateness_max_us);
    if (given.fault == Fault::command_gap)
      ++report.gaps;
    else if (given.fault != Fault::none)
      report.fault = to_string(given.fault);
  } while (report.fault.empty() && clock.now_ns() < end_ns);
  rig.watch({});
  rig.neutral();
  return report;
}

std::optional<double> lost_trials(const RehearsalReport& report, double trial_s) {
  if (!(report.presented_s > 0)) return std::nullopt;
  return -std::expm1(-report.gaps / report.presented_s * trial_s);
}

Check judge_rehearsal(const RehearsalReport& report, double trial_s) {
  if (report.presentations == 0)
    return {.what = "rehearsal",
            .verdict = Verdict::warn,
            .found = "not measured",
            .what_to_do = "let the measurement run to its end"};
  Check check = judge_loop({.what = "rehearsal",
                            .fifo = report.realtime.fifo(),
                            .p99_us = report.p99_us,
                            .largest_us = report.largest_us,
                            .ticks = report.ticks,
                            .overruns = report.overruns});
  std::string lost = fmt::format("{} of {} presentation{} lost to a gap between commands", report.gaps,
                                 report.presentations, report.presentations == 1 ? "" : "s");
  // Of none in some seconds nobody can tell how few would be lost in a session.
  if (const std::optional<double> share = lost_trials(report, trial_s); share && report.gaps > 0)
    lost += fmt::format(" (at this rate some {:.0f} of 100 trials, which present for {:.3g} s each)", 100 * *share,
                        trial_s);
  check.found = fmt::format("{}, in real time on a simulated rig; {}", lost, check.found);
  if (report.gaps > 0) {
    check.verdict = Verdict::bad;
    check.what_to_do = loop_advice(report.realtime.fifo());
  }
  if (!report.fault.empty()) {
    check.verdict = Verdict::bad;
    check.found += fmt::format("; ended by {}", report.fault);
    check.what_to_do = "a simulated rig has no such faults: please report this, with what jnd --version says";
  }
  return check;
}

}  // namespace jnd
