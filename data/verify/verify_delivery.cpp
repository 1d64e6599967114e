#include "data/verify/verify_delivery.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>

#include <fmt/format.h>

namespace jnd {

namespace {

// Of every device (devices/loop/control_loop.h, devices/loop/governor.h). A tick lasts one period, and one more for
// each that was skipped because the loop woke too late.
constexpr std::int64_t kPeriod_ns = 1'000'000;
constexpr std::int64_t kSoftStart_ns = 200'000'000;
constexpr double kRounding_n = 1e-12;
// Sums in another order of operations; every comparison is relative to the larger value.
constexpr double kTolerance = 1e-9;

bool agree(double a, double b) {
  return a == b || std::abs(a - b) <= kTolerance * std::max({std::abs(a), std::abs(b), 1e-6});
}

// The same sums as devices/loop/interval_summary.cpp makes while the loop runs.
struct Recomputed {
  std::int64_t ticks = 0;
  double peak_force_n = 0, deepest = 0, dwell_s = 0, saturated_s = 0, travel = 0, travel_s = 0;
  int contacts = 0;
  std::int64_t fit_samples = 0;
  double sum_xf = 0, sum_xx = 0;
  bool touching = false;
  double previous = 0;

  void add(const TickRecord& tick, std::int64_t begin_ns) {
    ++ticks;
    peak_force_n = std::max(peak_force_n, tick.measured_n);
    const double x = tick.penetration;
    if (!(x > 0)) {
      touching = false;
      return;
    }
    const std::int64_t periods = 1 + tick.lateness_ns / kPeriod_ns;
    const double duration_s = 1e-9 * static_cast<double>(kPeriod_ns * periods);
    if (touching) {
      travel += std::abs(x - previous);
      travel_s += duration_s;
    } else {
      ++contacts;
    }
    touching = true;
    previous = x;
    dwell_s += duration_s;
    deepest = std::max(deepest, x);
    const bool reduced = tick.asked_n - tick.given_n > kRounding_n;
    if (reduced) saturated_s += duration_s;
    if (reduced || tick.time_ns - begin_ns < kSoftStart_ns) return;
    ++fit_samples;
    sum_xf += x * tick.measured_n;
    sum_xx += x * x;
  }
};

class Comparison {
 public:
  Comparison(const FingerPresentation& finger, const TellProblem& problem) : finger_(finger), problem_(problem) {}

  void number(const char* what, double said, double computed) {
    ++compared;
    if (!agree(said, computed))
      problem_(fmt::format("of the stimulus delivered by the {} device of finger {} it says {} {}; its ticks give {}",
                           to_string(finger_.channel), finger_.finger + 1, what, said, computed));
  }

  std::int64_t compared = 0;

 private:
  const FingerPresentation& finger_;
  const TellProblem& problem_;
};

bool same_devices(const Presentation& presentation, const Telemetry& telemetry) {
  return telemetry_channels(presentation) == telemetry.channels;
}

// By device. Time that runs backwards within a device's ticks is said once.
std::vector<Recomputed> recompute(const Telemetry& telemetry, const TellProblem& problem) {
  std::vector<Recomputed> devices(telemetry.channels.size());
  std::vector<std::int64_t> last_ns(devices.size(), INT64_MIN);
  const std::int64_t begin_ns = telemetry.ticks.empty() ? 0 : telemetry.ticks.front().time_ns;
  bool backwards = false;
  for (const TickRecord& tick : telemetry.ticks) {
    const auto place = static_cast<std::size_t>(tick.channel);
    backwards = backwards || tick.time_ns < last_ns[place];
    last_ns[place] = tick.time_ns;
    devices[place].add(tick, begin_ns);
  }
  if (backwards) problem("the time of its ticks runs backwards");
  return devices;
}

}  // namespace

std::int64_t check_delivery(const Presentation& presentation, const Telemetry& telemetry, const Cues& cues, Unit unit,
                            const TellProblem& problem) {
  if (telemetry.unit != unit) problem("its ticks are in another unit than the study");
  if (!same_devices(presentation, telemetry)) {
    problem("its ticks are of other devices than it names");
    return 0;
  }
  const std::vector<Recomputed> devices = recompute(telemetry, problem);
  std::int64_t compared = 0;
  // Ticks that are lost leave nothing to compare.
  if (telemetry.dropped > 0) return 0;
  for (std::size_t i = 0; i < devices.size(); ++i) {
    const FingerPresentation& finger = presentation.fingers[i];
    const Recomputed& own = devices[i];
    Comparison comparison(finger, problem);
    comparison.number("ticks", static_cast<double>(presentation.ticks), static_cast<double>(own.ticks));
    comparison.number("a peak force in N of", finger.peak_force_n, own.peak_force_n);
    comparison.number("a deepest penetration of", finger.deepest_penetration, own.deepest);
    comparison.number("contacts:", finger.contacts, own.contacts);
    comparison.number("seconds in contact:", finger.dwell_s, own.dwell_s);
    comparison.number("a mean speed of", finger.mean_speed, own.travel_s > 0 ? own.travel / own.travel_s : 0);
    comparison.number("a saturated share of", finger.saturated_share,
                      own.dwell_s > 0 ? own.saturated_s / own.dwell_s : 0);
    const bool force = finger.channel == Channel::cutaneous ? cues.force : cues.kinaesthetic;
    comparison.number("samples fitted:", static_cast<double>(finger.fit_samples),
                      force ? static_cast<double>(own.fit_samples) : 0);
    // A joint whose study is in N/m works with the ratio of two lever arms, which no tick knows.
    const bool ratio = finger.channel == Channel::kinaesthetic && unit == Unit::n_per_m;
    if (finger.stiffness && force && !ratio)
      comparison.number("a stiffness of", *finger.stiffness, own.sum_xx > 0 ? own.sum_xf / own.sum_xx : 0);
    compared += comparison.compared;
  }
  return compared;
}

std::int64_t check_delivery(const std::vector<Presentation>& pieces, const Telemetry& telemetry, Unit unit,
                            const TellProblem& problem) {
  if (telemetry.unit != unit) problem("its ticks are in another unit than the study");
  if (pieces.empty() || !same_devices(pieces.front(), telemetry)) {
    problem("its ticks are of other devices than it names");
    return 0;
  }
  const std::vector<Recomputed> devices = recompute(telemetry, problem);
  std::int64_t compared = 0;
  if (telemetry.dropped > 0) return 0;
  for (std::size_t i = 0; i < devices.size(); ++i) {
    double ticks = 0, peak_force_n = 0, deepest = 0;
    for (const Presentation& piece : pieces) {
      if (i >= piece.fingers.size()) continue;
      ticks += static_cast<double>(piece.ticks);
      peak_force_n = std::max(peak_force_n, piece.fingers[i].peak_force_n);
      deepest = std::max(deepest, piece.fingers[i].deepest_penetration);
    }
    Comparison comparison(pieces.front().fingers[i], problem);
    comparison.number("ticks", ticks, static_cast<double>(devices[i].ticks));
    comparison.number("a peak force in N of", peak_force_n, devices[i].peak_force_n);
    comparison.number("a deepest penetration of", deepest, devices[i].deepest);
    compared += comparison.compared;
  }
  return compared;
}

}  // namespace jnd
