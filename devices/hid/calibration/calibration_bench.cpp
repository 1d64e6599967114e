#include "devices/hid/calibration/calibration_bench.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "devices/device_error.h"
#include "protocols/input/input_error.h"

namespace jnd {

namespace {

constexpr double kMicro = 1e-6;
constexpr int kReading_ticks = 1000;  // a second, for its mean and drift
constexpr int kSettle_ticks = 500;
constexpr double kRamp_n_per_tick = 0.002;  // 2 N/s: slow enough to be followed by hand
constexpr double kNothing_n = 0.05;

// The device while it presses with a steady force, or lies at rest.
class Hold {
 public:
  explicit Hold(BenchLink& link) : link_(link) {}

  void rest() {
    held_ = {};
    if (!link_.rest()) throw DeviceError("the device does not go to rest; switch it off");
  }
  // A straight way from the present force to that of the command.
  void press(const DeviceCommand& command) {
    if (held_.force_n == 0 && !link_.make_ready())
      throw DeviceError(fmt::format("the device cannot press ({}); run jnd device test", link_.trouble()));
    const double from_n = held_.force_n;
    const int ticks = std::max(1, static_cast<int>(std::ceil(std::abs(command.force_n - from_n) / kRamp_n_per_tick)));
    for (int i = 1; i <= ticks; ++i) {
      held_ = command;
      held_.force_n = from_n + (command.force_n - from_n) * i / ticks;
      held_.penetration_m = held_.force_n / held_.stiffness_n_per_m;
      tick();
    }
    held_ = command;
    for (int i = 0; i < kSettle_ticks; ++i) tick();
  }
  void tick() {
    if (held_.force_n == 0) {
      link_.silence();
      return;
    }
    if (link_.tick(held_).fault == Fault::none) return;
    throw DeviceError(fmt::format("the device stopped while it pressed ({}); run jnd device test", link_.trouble()));
  }

 private:
  BenchLink& link_;
  DeviceCommand held_;
};

struct Readings {
  std::vector<double> times_s, sensor_n;
};

Readings read_second(BenchLink& link, Hold& hold, const ForceTable& former) {
  Readings out;
  std::uint64_t first_us = 0;
  link.watch([&](const BenchSample& sample) {
    if (out.times_s.empty()) first_us = sample.telemetry.time_us;
    out.times_s.push_back(kMicro * static_cast<double>(sample.telemetry.time_us - first_us));
    out.sensor_n.push_back(sensor_of(former, kMicro * sample.telemetry.force_un));
  });
  for (int i = 0; i < kReading_ticks; ++i) hold.tick();
  link.watch({});
  return out;
}

std::string answered(Hold& hold, CalibrationOperator& person, const std::string& question) {
  person.ask(question);
  while (true) {
    if (std::optional<std::string> line = person.answer()) return *line;
    hold.tick();
  }
}

// Newtons as typed; none for an empty line. Asks again after what is no number.
std::optional<double> asked_force(Hold& hold, CalibrationOperator& person, const std::string& question) {
  while (true) {
    std::string line = answered(hold, person, question);
    line.erase(0, line.find_first_not_of(" \t"));
    line.erase(line.find_last_not_of(" \t\r") + 1);
    if (line.empty()) return std::nullopt;
    double value = 0;
    const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), value);
    if (error == std::errc() && end == line.data() + line.size() && std::isfinite(value)) return value;
    person.say(fmt::format("\"{}\" is no number of newtons, such as 1.25", line));
  }
}

}  // namespace

std::vector<ForceRecord> take_forces(BenchLink& link, const ForceTable& former,
                                     const std::vector<CalibrationStep>& steps, bool open_ended,
                                     CalibrationOperator& person) {
  std::vector<ForceRecord> records;
  Hold hold(link);
  hold.rest();
  for (std::size_t i = 0; i < steps.size() || open_ended; ++i) {
    const CalibrationStep step = i < steps.size() ? steps[i] : CalibrationStep{};
    const std::string place =
        open_ended ? fmt::format("point {}", i + 1) : fmt::format("point {} of {}", i + 1, steps.size());
    ForceRecord record;
    record.pushed_n = step.pushed_n;
    std::optional<double> known = step.known_n;
    if (step.pushed_n > 0)
      hold.press(BenchLink::push(step.pushed_n));
    else if (i > 0 && steps.size() > i && steps[i - 1].pushed_n > 0)
      hold.rest();
    if (known && step.pushed_n == 0)
      (void)answered(hold, person, fmt::format("{}: put {:g} N on the device, then press Enter", place, *known));
    else if (!known && step.pushed_n > 0)
      known = asked_force(hold, person, fmt::format("{}: it presses; the reference shows (N)", place));
    else if (!known)
      known =
          asked_force(hold, person, place + ": put a known force on the device and type it (N; an empty line ends)");
    if (!known) {
      if (open_ended) break;
      throw InputError("calibration: ended before its last point; nothing was changed");
    }
    const Readings readings = read_second(link, hold, former);
    record.point = {.known_n = *known, .sensor = summarise_readings(readings.times_s, readings.sensor_n)};
    record.sensor_n = readings.sensor_n;
    person.say(fmt::format("{}: {:.3f} N known, the sensor says {:.4f} N (SD {:.4f} N, drift {:+.4f} N/s)", place,
                           *known, record.point.sensor.mean, record.point.sensor.sd, record.point.sensor.drift_per_s));
    records.push_back(std::move(record));
  }
  hold.rest();
  return records;
}

StiffnessRecord take_stiffness(BenchLink& link, const ForceTable& former, const ForceTable& table,
                               double stiffness_n_per_m, double full_scale_n) {
  constexpr int kDepths = 5;
  constexpr double kShare = 0.7;
  StiffnessRecord record;
  Hold hold(link);
  hold.rest();
  for (int i = 1; i <= kDepths; ++i) {
    DeviceCommand command;
    command.stiffness_n_per_m = stiffness_n_per_m;
    command.penetration_m = kShare * full_scale_n / stiffness_n_per_m * i / kDepths;
    command.force_n = stiffness_n_per_m * command.penetration_m;
    hold.press(command);
    Readings readings = read_second(link, hold, former);
    for (double& reading : readings.sensor_n) reading = force_of(table, reading);
    record.points.push_back(
        {.depth_m = command.penetration_m, .force = summarise_readings(readings.times_s, readings.sensor_n)});
  }
  hold.rest();
  if (std::abs(record.points.back().force.mean - record.points.front().force.mean) < kNothing_n)
    throw DeviceError("the device presses on nothing: put the reference or a finger before its platform");
  record.fit = fit_stiffness(stiffness_n_per_m, record.points);
  return record;
}

void store_calibration(PageExchange& pages, const ForceTable& table, const jnd_certificate& certificate) {
  const jnd_force_table former_table = pages.force_table();
  const jnd_certificate former_certificate = pages.certificate();
  try {
    pages.store(to_report(table));
    pages.store(certificate);
  } catch (const DeviceError& error) {
    std::string state = "its former calibration was put back";
    try {
      pages.store(former_table);
      pages.store(former_certificate);
    } catch (const DeviceError&) {
      state = "its former calibration could not be put back: calibrate it again before it is used";
    }
    throw DeviceError(fmt::format("{}; {}", error.what(), state));
  }
}

}  // namespace jnd
