// Whether a rehearsal in real time keeps its trials on this machine: presentations of a rig, as a session makes them.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>

#include "devices/check.h"
#include "devices/rig.h"

namespace jnd {

struct RehearsalReport {
  RealtimeReport realtime;
  int presentations = 0;
  int gaps = 0;            // of them, ended because a command came too late (Fault::command_gap): each voids its trial
  std::string fault{};     // another one that ended a presentation, and with it the measurement
  double presented_s = 0;  // all presentations together
  std::int64_t ticks = 0;
  std::int64_t overruns = 0;  // whole periods of 1 ms skipped
  double p99_us = 0;          // lateness, of the presentation in which it was largest
  double largest_us = 0;
};

// Presents `stimulus` again and again, half a second from first contact each, for about `seconds` (> 0), at least once;
// ends early where `stop` is set. The rig's loop must run on the real clock.
RehearsalReport probe_rehearsal(Rig& rig, const Stimulus& stimulus, double seconds, const std::atomic<bool>& stop);

// The share of trials that gaps would void, 0..1, where each presents for trial_s (> 0) and gaps come as often as in the
// rehearsal, independently of one another: 1 - exp(-gaps / presented_s * trial_s). Nothing where nothing was presented.
std::optional<double> lost_trials(const RehearsalReport& report, double trial_s);

// Bad where a presentation was lost; otherwise by the limits of every loop (devices/loop/control_loop.h).
// trial_s: for how long a trial of usual length presents, > 0.
Check judge_rehearsal(const RehearsalReport& report, double trial_s);

}  // namespace jnd
