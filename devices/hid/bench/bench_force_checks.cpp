// The checks in which a device presses and vibrates, all of it through the governor; and those of a tracker.
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "devices/device_error.h"
#include "devices/hid/bench/bench_checks.h"
#include "devices/hid/report_words.h"

namespace jnd {

namespace {

constexpr double kMicro = 1e-6, kMilli = 1e-3;

std::string trouble(const BenchLink& link) {
  const std::string words = fault_words(link.telemetry().faults);
  const std::string what =
      link.fault() == Fault::none ? "did not become active" : fmt::format("ended by {}", to_string(link.fault()));
  return what + (words.empty() ? "" : ": " + words);
}

// Force as measured while something goes on.
struct ForceWatch {
  double sum = 0, largest = 0;
  int count = 0;
  void look(const jnd_telemetry& telemetry) noexcept {
    const double force_n = kMicro * telemetry.force_un;
    sum += force_n;
    largest = std::max(largest, force_n);
    ++count;
  }
  double mean() const noexcept { return count > 0 ? sum / count : 0; }
};

// The force goes in a straight line from one to the other. False where a fault ended it.
bool ramp(BenchLink& link, double from_n, double to_n, int ticks) {
  for (int i = 1; i <= ticks; ++i)
    if (link.tick(BenchLink::push(from_n + (to_n - from_n) * i / ticks)).fault != Fault::none) return false;
  return true;
}

}  // namespace

void check_force(BenchLink& link, BenchChecks& checks) {
  constexpr int kRamp_ticks = 1000, kSettle_ticks = 300, kHold_ticks = 300;
  constexpr double kTolerance_n = 0.1, kNothing_n = 0.05, kMostOver_n = 0.2;
  BenchCheck check{.what = fmt::format("force of {:g} N", kTestForce_n),
                   .measured = "",
                   .expected = fmt::format("{:g} N -+ {:g} N, on a finger or a reference", kTestForce_n, kTolerance_n),
                   .ok = false};
  ForceWatch all, held;
  link.watch([&all](const BenchSample& sample) { all.look(sample.telemetry); });
  bool well = link.make_ready();
  well = well && ramp(link, 0, kTestForce_n, kRamp_ticks);
  well = well && ramp(link, kTestForce_n, kTestForce_n, kSettle_ticks);
  link.watch([&all, &held](const BenchSample& sample) {
    all.look(sample.telemetry);
    held.look(sample.telemetry);
  });
  well = well && ramp(link, kTestForce_n, kTestForce_n, kHold_ticks);
  link.watch({});
  well = well && ramp(link, kTestForce_n, 0, kRamp_ticks / 4);
  check.measured = well ? fmt::format("{:.3f} N", held.mean()) : trouble(link);
  check.ok = well && std::abs(held.mean() - kTestForce_n) <= kTolerance_n;
  if (well && std::abs(held.mean()) < kNothing_n) {
    check.measured += ": it met nothing";
    check.judged = false;
    check.ok = true;
  }
  checks.push_back(check);
  checks.push_back({.what = "largest force meanwhile",
                    .measured = fmt::format("{:.3f} N", all.largest),
                    .expected = fmt::format("at most {:g} N", kTestForce_n + kMostOver_n),
                    .ok = all.largest <= kTestForce_n + kMostOver_n});
}

void check_vibration(BenchLink& link, BenchChecks& checks) {
  constexpr int kBurst_ticks = 100, kLast_ticks = 30, kAfter_ticks = 300;
  constexpr double kTolerance = 0.25;
  const DeviceSpec& spec = link.spec();
  DeviceCommand command = BenchLink::push(0);
  command.vibration_g = (spec.min_vibration_g + spec.max_vibration_g) / 2;
  command.vibration_hz = (spec.min_vibration_hz + spec.max_vibration_hz) / 2;
  double last_g = 0, after_g = 0;
  bool well = link.make_ready();
  for (int i = 0; well && i < kBurst_ticks; ++i) {
    if (i == kBurst_ticks - kLast_ticks)
      link.watch(
          [&last_g](const BenchSample& sample) { last_g = std::max(last_g, kMilli * sample.telemetry.vibration_mg); });
    well = link.tick(command).fault == Fault::none;
  }
  link.watch({});
  well = well && ramp(link, 0, 0, kAfter_ticks);
  after_g = kMilli * link.telemetry().vibration_mg;
  checks.push_back(
      {.what = "vibration burst of 100 ms",
       .measured = well ? fmt::format("{:.3f} g, {:.3f} g afterwards", last_g, after_g) : trouble(link),
       .expected = fmt::format("{:.3f} g -+ {:g} %, then below {:g} g", command.vibration_g, 100 * kTolerance,
                               spec.min_vibration_g),
       .ok = well && std::abs(last_g / command.vibration_g - 1) <= kTolerance && after_g < spec.min_vibration_g});
}

void check_rest(BenchLink& link, BenchChecks& checks) {
  constexpr int kSettle_ticks = 300;
  constexpr double kMostForce_n = 0.1;
  const bool rests = link.rest();
  for (int i = 0; i < kSettle_ticks; ++i) link.silence();
  const jnd_telemetry& now = link.telemetry();
  const double force_n = kMicro * now.force_un;
  checks.push_back(
      {.what = "back at rest",
       .measured = fmt::format("{}, {:.3f} N, {:.3f} g, platform at {:.2f} mm", state_word(now.state), force_n,
                               kMilli * now.vibration_mg, 1e-6 * now.height_nm),
       .expected = fmt::format("at rest, within {:g} N of zero, no vibration", kMostForce_n),
       .ok = rests && now.state == JND_STATE_REST && std::abs(force_n) <= kMostForce_n && now.vibration_mg == 0});
}

void check_poses(HidHandle& handle, Clock& clock, double seconds, const std::atomic<bool>& interrupted,
                 BenchChecks& checks) {
  struct Finger {
    int poses = 0, seen = 0;
  };
  std::array<Finger, JND_LITTLE + 1> fingers{};
  ReportCounter counter;
  std::int64_t damaged = 0;
  std::uint64_t last_us = 0;
  bool backwards = false;
  std::array<std::uint8_t, JND_REPORT_SIZE> report{};
  const auto ticks = static_cast<std::int64_t>(seconds * 1e9) / BenchLink::kTick_ns;
  const std::int64_t start_ns = clock.now_ns();
  for (std::int64_t i = -1; i < ticks; ++i) {  // tick -1: what had waited unread
    if (i >= 0) clock.sleep_until_ns(start_ns + (i + 1) * BenchLink::kTick_ns);
    if (interrupted) throw BenchInterrupted();
    for (int waiting = 0; waiting < 256; ++waiting) {
      const int count = handle.read(report, 0);
      if (count == kHidTimeOut) break;
      if (count == kHidGone)
        throw DeviceError(fmt::format("the tracker is gone ({}); look at its cable", handle.error()));
      if (i < 0) continue;
      jnd_pose pose{};
      const jnd_decode_result result = jnd_decode_pose(report.data(), static_cast<std::size_t>(count), &pose);
      if (result == JND_DECODE_ID) continue;
      if (result != JND_DECODE_OK) {
        ++damaged;
        continue;
      }
      if (!counter.take(pose.sequence)) continue;
      // Fingers that were measured together have the same time.
      backwards = backwards || pose.time_us < last_us;
      last_us = pose.time_us;
      ++fingers[pose.finger].poses;
      fingers[pose.finger].seen += pose.seen ? 1 : 0;
    }
  }
  constexpr double kLeastRate_hz = 100;
  bool any = false;
  for (unsigned finger = JND_THUMB; finger <= JND_LITTLE; ++finger) {
    const Finger& one = fingers[finger];
    if (one.poses == 0) continue;
    any = true;
    const double rate_hz = one.poses / seconds;
    checks.push_back(
        {.what = fmt::format("poses of the {} finger", finger_word(finger)),
         .measured = fmt::format("{:.1f} a second, seen in {:.1f} %", rate_hz, 100.0 * one.seen / one.poses),
         .expected = fmt::format("at least {:g} a second", kLeastRate_hz),
         .ok = rate_hz >= kLeastRate_hz});
  }
  if (!any) checks.push_back({.what = "poses", .measured = "none", .expected = "of a finger at least", .ok = false});
  checks.push_back({.what = "reports missing, damaged",
                    .measured = fmt::format("{}, {} of {}", counter.missing(), damaged, counter.taken()),
                    .expected = "0, 0",
                    .ok = counter.missing() == 0 && damaged == 0});
  checks.push_back(
      {.what = "its clock", .measured = backwards ? "went backwards" : "rises", .expected = "rises", .ok = !backwards});
}

}  // namespace jnd
