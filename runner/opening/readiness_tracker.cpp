// Readiness of the fingers' poses, where they come from outside the program.
#include <algorithm>
#include <chrono>
#include <string>
#include <thread>

#include <fmt/format.h>

#include "devices/trackers/pose_feed.h"
#include "runner/keys/interrupt.h"
#include "runner/opening/readiness_items.h"

namespace jnd {

namespace {

using Steady = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kPatience{1000};  // for the first poses, and for a hand to be held out
constexpr std::chrono::milliseconds kWatch{500};      // how long the stream is then watched
constexpr std::chrono::milliseconds kLookEvery{5};
constexpr double kMostMissed = 0.1;  // of the looks: more is no hiccup of this machine's

// Whether nothing is missing by the end of the patience; `missing` says what is.
bool comes(Rig& rig, std::string& missing) {
  const auto until = Steady::now() + kPatience;
  for (missing = rig.missing(); !missing.empty(); missing = rig.missing()) {
    if (Steady::now() > until || interrupt_requested().load()) return false;
    std::this_thread::sleep_for(kLookEvery);
  }
  return true;
}

// The share of looks at which something was missing.
double missed(Rig& rig, std::string& missing) {
  int looks = 0, gone = 0;
  for (const auto until = Steady::now() + kWatch; Steady::now() < until && !interrupt_requested().load();) {
    const std::string now = rig.missing();
    ++looks;
    if (!now.empty()) {
      ++gone;
      missing = now;
    }
    std::this_thread::sleep_for(kLookEvery);
  }
  return looks > 0 ? static_cast<double>(gone) / looks : 0;
}

void complain(Check& check, Verdict verdict, const std::string& why, const char* what_to_do) {
  check.verdict = std::max(check.verdict, verdict);
  check.found += "; " + why;
  check.what_to_do += (check.what_to_do.empty() ? "" : "; ") + std::string(what_to_do);
}

}  // namespace

Check check_tracker(Rig& rig) {
  Check check{.what = "tracker", .verdict = Verdict::ok};
  std::string missing;
  const bool came = comes(rig, missing);
  const double share = came ? missed(rig, missing) : 1;
  const TrackerReport report = rig.connections().tracker.value_or(TrackerReport{});
  check.found = fmt::format("{} {}: {:.0f} poses a second, {:.1f} ms old at most in 99 % of cases", report.kind,
                            report.source, report.rate_hz, report.latency_p99_ms);
  constexpr const char* kSee = "hold the fingers where the tracker sees them, and look at its program and its cable";
  if (!came || share > kMostMissed)
    complain(check, Verdict::bad, missing, kSee);
  else if (share > 0)
    complain(check, Verdict::warn, fmt::format("now and then ({:.0f} %): {}", 100 * share, missing), kSee);
  if (came && report.rate_hz < kLeastPoseRate_hz)
    complain(check, Verdict::bad, fmt::format("fewer than {:.0f} poses a second of a finger", kLeastPoseRate_hz),
             "let the tracker send more often: poses older than 20 ms take the force away");
  if (report.refused > 0)
    complain(check, Verdict::warn,
             fmt::format("{} lines or reports were refused{}", report.refused,
                         report.trouble.empty() ? "" : ": " + report.trouble),
             "correct the tracker's program: devices/trackers/README.md has the format");
  return check;
}

}  // namespace jnd
