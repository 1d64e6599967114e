// Is this machine fit to run a session: one finding each about its kernel, processors, clock, devices, disk and
// punctuality, with numbers and with what to do. What `jnd doctor` prints.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "devices/check.h"
#include "devices/clock.h"
#include "devices/loop/interval_summary.h"
#include "devices/realtime.h"
#include "devices/rig.h"

namespace jnd {

// How punctually this machine wakes a thread: the loop's own waiting, on absolute deadlines, without a device.
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

// Each reads what it needs below `root` ("/", or a made-up tree in tests): sys, proc and dev. What a kernel does not
// show is said and is no failure.
Check check_kernel(const std::filesystem::path& root);        // release, preemption
Check check_processors(const std::filesystem::path& root);    // how many, isolated ones, load of the last minute
Check check_frequency(const std::filesystem::path& root);     // frequency governors
Check check_clock_source(const std::filesystem::path& root);  // what the monotonic clock reads
Check check_hid(const std::filesystem::path& root);           // dev/hidraw*: which, and may they be used

// What the kernel gave a thread that asked: scheduling, memory, processor, timer slack; none for a report of `off`.
Checks check_realtime(const RealtimeReport& report);

// The folder where studies go, or a study in it (which need not exist yet): file system, free space, time of an fsync
// of 4 kB (a temporary file that is removed). `is_network` judges statfs(2)'s f_type; mounts are looked up in
// root/proc/self/mountinfo.
struct StorageProbe {
  std::filesystem::path root = "/";
  std::function<bool(long)> is_network;
  int syncs = 20;
  bool real = true;         // for real sessions; a rehearsal may be kept where it can be lost, and is warned
  double needed_bytes = 0;  // of a session, beside what should be free anyway
};
Check check_storage(const std::filesystem::path& folder_or_file, const StorageProbe& probe);
// The same judgement on given figures.
struct StorageFigures {
  std::string folder, type;  // type: "ext4"; empty where unknown
  bool network = false;
  double free_bytes = 0;
  double sync_median_s = 0, sync_max_s = 0;
  bool real = true;
  double needed_bytes = 0;
};
Check judge_storage(const StorageFigures& figures);

// How punctual a loop of 1 kHz was, judged by devices/loop/control_loop.h: the same figures get the same verdict
// wherever they were measured.
struct LoopFigures {
  std::string what;                      // of the check
  bool fifo = false;                     // it had SCHED_FIFO
  double p99_us = 0, largest_us = 0;     // lateness
  std::int64_t ticks = 0, overruns = 0;  // overruns: whole periods skipped
};
Check judge_loop(const LoopFigures& figures);
std::string loop_advice(bool fifo);  // what to do about one that was not
// The measured lateness of a 1 kHz loop without a device, judged by devices/loop/control_loop.h.
Check judge_jitter(const JitterReport& report);
// Its figures: "p50 8 us, p99 20 us, largest 90 us over 3000 ticks of 1 ms, 0 skipped (0 %)".
std::string jitter_text(const JitterReport& report);

// Limits of the judgements of disks.
inline constexpr double kFewBytes = 1e9, kTooFewBytes = 1e8;
inline constexpr double kSlowSync_s = 0.05, kTooSlowSync_s = 1;  // one sync a trial, before the participant goes on

// Whether a rehearsal in real time keeps its trials on this machine: presentations of a rig, as a session makes them.
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
