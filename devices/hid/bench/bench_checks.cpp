// The checks that give no force: what a device says, how its reports come, and that it stops by itself.
#include "devices/hid/bench/bench_checks.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "devices/device_error.h"
#include "devices/hid/device_fit.h"
#include "devices/hid/report_words.h"

namespace jnd {

namespace {

using Report = std::array<std::uint8_t, JND_REPORT_SIZE>;

// A step of the device's loop and one of the host's, on top of a time that is counted in steps.
constexpr int kSlack_ms = 3;

std::string none_or(const std::string& words) {
  return words.empty() ? "none" : words;
}

// The device's clock against the host's: the slope of a straight line through (arrival, time).
struct ClockLine {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  void add(double host_s, double device_s) noexcept {
    n += 1;
    x += host_s;
    y += device_s;
    xx += host_s * host_s;
    xy += host_s * device_s;
  }
  double slope() const noexcept {
    const double spread = n * xx - x * x;
    return spread > 0 ? (n * xy - x * y) / spread : 0;
  }
};

// How long the device needed to stop, by its own clock, from the last accepted command; the watch of a BenchLink.
struct StopWatch {
  bool stopped = false;
  double after_ms = 0;
  unsigned faults = 0;
  std::uint64_t accepted_us = 0;
  void look(const jnd_telemetry& telemetry) noexcept {
    if (telemetry.state == JND_STATE_ACTIVE && telemetry.command_age_us != JND_COMMAND_AGE_NONE)
      accepted_us = telemetry.time_us - telemetry.command_age_us;
    if (telemetry.state != JND_STATE_STOPPED || stopped) return;
    stopped = true;
    after_ms = 1e-3 * static_cast<double>(telemetry.time_us - accepted_us);
    faults = telemetry.faults;
  }
};

// Ready, then `disturb` each tick until the device has stopped or has had ten times its time.
template <typename Disturb>
void check_stop(BenchLink& link, const jnd_identity& identity, const std::string& what, const Disturb& disturb,
                Checks& checks) {
  Check check{.what = what, .verdict = Verdict::bad};
  check.limit = fmt::format("stopped by its watchdog within {} ms", identity.watchdog_ms + kSlack_ms);
  if (!link.make_ready()) {
    check.found = link.trouble();
    checks.push_back(check);
    (void)link.rest();
    return;
  }
  StopWatch watch;
  link.watch([&watch](const BenchSample& sample) { watch.look(sample.telemetry); });
  for (int i = 0; i < 10 * identity.watchdog_ms && !watch.stopped; ++i) disturb(i);
  link.watch({});
  check.found = watch.stopped ? fmt::format("stopped after {:.1f} ms ({})", watch.after_ms, fault_words(watch.faults))
                              : std::string("did not stop");
  if (watch.stopped && watch.after_ms <= identity.watchdog_ms + kSlack_ms && (watch.faults & JND_FAULT_WATCHDOG) != 0)
    check.verdict = Verdict::ok;
  checks.push_back(check);
  const bool rests = link.rest();
  checks.push_back(measured(
      what + ": then rest",
      fmt::format("{}, faults: {}", state_word(link.telemetry().state), none_or(fault_words(link.telemetry().faults))),
      "at rest, faults: none", rests && link.telemetry().faults == 0));
}

}  // namespace

void check_description(const HidInfo& info, const jnd_identity& identity, const jnd_limits& limits, Checks& checks) {
  checks.push_back(
      measured("report protocol", fmt::format("versions {} to {}", identity.lowest_version, identity.highest_version),
               fmt::format("version {}", int{JND_PROTOCOL_VERSION}),
               identity.lowest_version <= JND_PROTOCOL_VERSION && identity.highest_version >= JND_PROTOCOL_VERSION));
  const std::string serial = serial_of(identity);
  checks.push_back(measured("serial number", serial,
                            info.serial.empty()       ? "any (USB names none)"
                            : info.transport == "USB" ? info.serial + ", as USB says"
                                                      : info.serial,
                            info.serial.empty() || serial == info.serial));
  checks.push_back(measured("watchdog", fmt::format("{} ms", identity.watchdog_ms),
                            fmt::format("1 to {} ms", kLongestWatchdog_ms),
                            identity.watchdog_ms >= 1 && identity.watchdog_ms <= kLongestWatchdog_ms));
  constexpr int kLeastRate_hz = 200;
  checks.push_back(measured("rate that it names", fmt::format("{} Hz", identity.loop_rate_hz),
                            fmt::format("at least {} Hz", kLeastRate_hz), identity.loop_rate_hz >= kLeastRate_hz));
  checks.push_back(measured("force that it gives at most", fmt::format("{:g} N", kMicro * limits.most_force_un),
                            fmt::format("at least the {:g} N of this test", kTestForce_n),
                            kMicro * limits.most_force_un >= kTestForce_n));
}

void check_stream(BenchLink& link, const jnd_identity& identity, double seconds, Checks& checks) {
  const bool rests = link.rest();
  checks.push_back(measured("state at first",
                            link.heard() ? std::string(state_word(link.telemetry().state)) : "no telemetry", "at rest",
                            rests));
  const std::int64_t taken = link.counter().taken(), missing = link.counter().missing(), damaged = link.damaged();
  ClockLine line;
  bool backwards = false;
  std::uint64_t first_us = 0, last_us = 0;
  std::int64_t first_ns = 0, last_ns = 0;
  link.watch([&](const BenchSample& sample) {
    const std::uint64_t time_us = sample.telemetry.time_us;
    if (line.n == 0) {
      first_ns = sample.arrival_ns;
      first_us = time_us;
    } else {
      backwards = backwards || time_us <= last_us;
    }
    last_us = time_us;
    last_ns = sample.arrival_ns;
    line.add(1e-9 * static_cast<double>(last_ns - first_ns), 1e-6 * static_cast<double>(last_us - first_us));
  });
  const auto ticks = static_cast<std::int64_t>(seconds * 1e9) / BenchLink::kTick_ns;
  for (std::int64_t i = 0; i < ticks; ++i) link.silence();
  link.watch({});
  const double took_s = 1e-9 * static_cast<double>(last_ns - first_ns);
  const double rate_hz = took_s > 0 ? static_cast<double>(link.counter().taken() - taken - 1) / took_s : 0;
  constexpr double kMostRateError = 0.05;
  checks.push_back(measured("rate of telemetry", fmt::format("{:.1f} Hz over {:.1f} s", rate_hz, took_s),
                            fmt::format("{} Hz ± {:g} %", identity.loop_rate_hz, 100 * kMostRateError),
                            std::abs(rate_hz / identity.loop_rate_hz - 1) <= kMostRateError));
  checks.push_back(measured("reports missing, damaged",
                            fmt::format("{}, {} of {}", link.counter().missing() - missing, link.damaged() - damaged,
                                        link.counter().taken() - taken),
                            "0, 0", link.counter().missing() == missing && link.damaged() == damaged));
  // The protocol asks for 100 ppm; over seconds the arrivals' own spread is more than that.
  constexpr double kMostDrift_ppm = 2000;
  const double drift_ppm = 1e6 * (line.slope() - 1);
  checks.push_back(measured(
      "its clock", fmt::format("{}, {:+.0f} ppm", backwards ? "went backwards" : "rises", std::round(drift_ppm) + 0.0),
      fmt::format("rises, within {:g} ppm over {:g} s", kMostDrift_ppm, seconds),
      line.n > 1 && !backwards && std::abs(drift_ppm) <= kMostDrift_ppm));
  const jnd_telemetry& now = link.telemetry();
  std::string readings;
  if (now.temperature_cdeg != JND_TEMPERATURE_NONE) readings += fmt::format(", {:.1f} C", 0.01 * now.temperature_cdeg);
  if (now.battery_percent != JND_BATTERY_NONE) readings += fmt::format(", battery {} %", now.battery_percent);
  checks.push_back(measured("faults", none_or(fault_words(now.faults)) + readings, "none", now.faults == 0));
}

void check_round_trip(BenchLink& link, Checks& checks) {
  constexpr int kCommands = 200, kPatience_ticks = 100;
  std::vector<double> trips_ms;
  int lost = 0;
  for (int i = 0; i < kCommands; ++i) {
    Report report{};
    const jnd_command command = link.rest_command();
    jnd_encode_command(&command, report.data());
    link.send_raw(report);
    const std::int64_t sent_ns = link.now_ns();
    std::int64_t heard_ns = 0;
    link.watch([&](const BenchSample& sample) {
      if (heard_ns == 0 && sample.telemetry.command_sequence == command.sequence) heard_ns = sample.arrival_ns;
    });
    for (int tick = 0; tick < kPatience_ticks && heard_ns == 0; ++tick) link.silence();
    link.watch({});
    if (heard_ns == 0)
      ++lost;
    else
      trips_ms.push_back(1e-6 * static_cast<double>(heard_ns - sent_ns));
  }
  std::sort(trips_ms.begin(), trips_ms.end());
  constexpr double kMostTrip_ms = 10;  // half of what poses and readings may be old
  const double median_ms = trips_ms.empty() ? 0 : trips_ms[trips_ms.size() / 2];
  checks.push_back(measured("command to its echo",
                            trips_ms.empty() ? std::string("no echo")
                                             : fmt::format("median {:.1f} ms, longest {:.1f} ms; {} of {} lost",
                                                           median_ms, trips_ms.back(), lost, kCommands),
                            fmt::format("median at most {:g} ms, in steps of 1 ms; 0 lost", kMostTrip_ms),
                            lost == 0 && median_ms <= kMostTrip_ms));
}

void check_watchdog(BenchLink& link, const jnd_identity& identity, Checks& checks) {
  check_stop(
      link, identity, "no more commands", [&link](int) { link.silence(); }, checks);
}

void check_refusals(BenchLink& link, const jnd_identity& identity, Checks& checks) {
  // Damaged ones, each with one bit of its CRC wrong: none of them may keep the device going.
  int sent = 0;
  unsigned before = 0;
  check_stop(
      link, identity, "damaged commands only",
      [&](int i) {
        if (i == 0) before = link.telemetry().rejected;
        Report report{};
        const jnd_command command = link.next_command(BenchLink::push(0));
        jnd_encode_command(&command, report.data());
        report[JND_REPORT_SIZE - 1] ^= static_cast<std::uint8_t>(1U << static_cast<unsigned>(i % 8));
        link.send_raw(report);
        ++sent;
      },
      checks);
  const unsigned refused = (link.telemetry().rejected - before) & 0xFFFFU;
  checks.push_back(measured("damaged commands refused", fmt::format("{} of {}", refused, sent),
                            sent > 0 ? fmt::format("{} of {}", sent, sent) : std::string("all of some"),
                            sent > 0 && refused == static_cast<unsigned>(sent)));
  // And one good command again and again: its number is not newer than itself.
  Report again{};
  check_stop(
      link, identity, "one command repeated",
      [&](int i) {
        if (i == 0) {
          const jnd_command command = link.next_command(BenchLink::push(0));
          jnd_encode_command(&command, again.data());
        }
        link.send_raw(again);
      },
      checks);
}

// The checks in which a device presses and vibrates, all of it through the governor; and those of a tracker.

namespace {

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

void check_force(BenchLink& link, Checks& checks) {
  constexpr int kRamp_ticks = 1000, kSettle_ticks = 300, kHold_ticks = 300;
  constexpr double kTolerance_n = 0.1, kNothing_n = 0.05, kMostOver_n = 0.2;
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
  Check check = measured(fmt::format("force of {:g} N", kTestForce_n),
                         well ? fmt::format("{:.3f} N", held.mean()) : link.trouble(),
                         fmt::format("{:g} N ± {:g} N, on a finger or a reference", kTestForce_n, kTolerance_n),
                         well && std::abs(held.mean() - kTestForce_n) <= kTolerance_n);
  if (well && std::abs(held.mean()) < kNothing_n) {
    check.found += ": it met nothing";
    check.verdict = Verdict::not_judged;
  }
  checks.push_back(check);
  checks.push_back(measured("largest force meanwhile", fmt::format("{:.3f} N", all.largest),
                            fmt::format("at most {:g} N", kTestForce_n + kMostOver_n),
                            all.largest <= kTestForce_n + kMostOver_n));
}

void check_vibration(BenchLink& link, Checks& checks) {
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
  checks.push_back(measured(
      "vibration burst of 100 ms",
      well ? fmt::format("{:.3f} g, {:.3f} g afterwards", last_g, after_g) : link.trouble(),
      fmt::format("{:.3f} g ± {:g} %, then below {:g} g", command.vibration_g, 100 * kTolerance, spec.min_vibration_g),
      well && std::abs(last_g / command.vibration_g - 1) <= kTolerance && after_g < spec.min_vibration_g));
}

void check_rest(BenchLink& link, Checks& checks) {
  constexpr int kSettle_ticks = 300;
  constexpr double kMostForce_n = 0.1;
  const bool rests = link.rest();
  for (int i = 0; i < kSettle_ticks; ++i) link.silence();
  const jnd_telemetry& now = link.telemetry();
  const double force_n = kMicro * now.force_un;
  checks.push_back(
      measured("back at rest",
               fmt::format("{}, {:.3f} N, {:.3f} g, platform at {:.2f} mm", state_word(now.state), force_n,
                           kMilli * now.vibration_mg, 1e-6 * now.height_nm),
               fmt::format("at rest, within {:g} N of zero, no vibration", kMostForce_n),
               rests && now.state == JND_STATE_REST && std::abs(force_n) <= kMostForce_n && now.vibration_mg == 0));
}

void check_poses(HidHandle& handle, Clock& clock, double seconds, const std::atomic<bool>& interrupted,
                 Checks& checks) {
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
    checks.push_back(measured(fmt::format("poses of the {} finger", finger_word(finger)),
                              fmt::format("{:.1f} a second, seen in {:.1f} %", rate_hz, 100.0 * one.seen / one.poses),
                              fmt::format("at least {:g} a second", kLeastRate_hz), rate_hz >= kLeastRate_hz));
  }
  if (!any) checks.push_back(measured("poses", "none", "of a finger at least", false));
  checks.push_back(measured("reports missing, damaged",
                            fmt::format("{}, {} of {}", counter.missing(), damaged, counter.taken()), "0, 0",
                            counter.missing() == 0 && damaged == 0));
  checks.push_back(measured("its clock", backwards ? "went backwards" : "rises", "rises", !backwards));
}

}  // namespace jnd
