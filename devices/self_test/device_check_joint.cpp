// What a McKibben finger can do, measured: free motion, steps of force, venting, rendered stiffness, its encoder.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "analysis/numerics/special_values.h"
#include "devices/mckibben/mckibben_device.h"
#include "devices/mckibben/mckibben_response.h"
#include "devices/self_test/device_bench.h"

namespace jnd {

namespace {

constexpr int kJointSettled_ticks = 1500;
constexpr double kDegree = std::numbers::pi / 180;

Check range(const DeviceSpec& spec) {
  const AngleRange usable = MckibbenLinkage(spec.finger).usable();
  const double off =
      std::max(std::abs(usable.min_rad - spec.lowest_travel), std::abs(usable.max_rad - spec.highest_travel));
  return measured("range of the linkage, against its description",
                  fmt::format("{:.3f} to {:.3f} deg", usable.min_rad / kDegree, usable.max_rad / kDegree),
                  fmt::format("{:.3f} to {:.3f} deg", spec.lowest_travel / kDegree, spec.highest_travel / kDegree),
                  off <= 1e-6);
}

Check stops(const DeviceSpec& spec) {
  DeviceBench bench(spec);
  double least = kInf, most = -least;
  bench.make_ready();
  for (const double angle : {spec.lowest_travel - 0.2, spec.highest_travel + 0.2}) {
    bench.finger().put(angle);
    bench.ticks(50, bench.push(0));
    least = std::min(least, bench.reading().travel);
    most = std::max(most, bench.reading().travel);
  }
  return measured("a finger pressed past both ends", fmt::format("{:.4f} to {:.4f} rad", least, most),
                  fmt::format("within {:.4f} to {:.4f} rad", spec.lowest_travel, spec.highest_travel),
                  least >= spec.lowest_travel - 1e-6 && most <= spec.highest_travel + 1e-6);
}

Check encoder(const DeviceSpec& spec) {
  const double pulses = spec.sensors.encoder_pulses;  // a turn; 0: ideal
  const double step_rad = pulses > 0 ? 2 * std::numbers::pi / pulses : 2e-9;
  DeviceBench bench(spec);
  bench.make_ready();
  double worst = 0;
  constexpr int kPoints = 400;
  for (int i = 0; i <= kPoints; ++i) {
    const double angle = spec.lowest_travel + (spec.highest_travel - spec.lowest_travel) * i / kPoints;
    bench.finger().put(angle);
    bench.ticks(3, bench.push(0));
    worst = std::max(worst, std::abs(bench.reading().travel - angle));
  }
  return measured("encoder against the true angle, over the range", fmt::format("{:.5f} rad off", worst),
                  fmt::format("half a step, {:.5f} rad", step_rad / 2), worst <= step_rad / 2 * (1 + 1e-9));
}

// The finger goes to and fro once in two seconds, as in the paper's tracking experiments.
Check free_motion(const DeviceSpec& spec) {
  constexpr double kLimit_n = 0.5;
  DeviceBench bench(spec);
  bench.finger().put(spec.lowest_travel);
  bench.make_ready();
  double most = 0;
  for (int i = 0; i < 4000; ++i) {
    const double share = (1 - std::cos(2 * std::numbers::pi * i / 2000)) / 2;
    bench.finger().put(spec.lowest_travel + (spec.highest_travel - spec.lowest_travel) * share);
    (void)bench.tick(bench.push(0));
    most = std::max(most, std::abs(bench.reading().force_n));
  }
  return measured("free motion: force while it flexes at 0.5 Hz", fmt::format("{:.3f} N", most),
                  fmt::format("at most {:g} N", kLimit_n), most <= kLimit_n);
}

Check step(const DeviceSpec& spec, double angle_rad) {
  constexpr double kAsked_n = 5, kBand_n = 0.1;  // 2 %
  DeviceBench bench(spec);
  bench.finger().put(angle_rad);
  bench.make_ready();
  int settled_ms = 0;
  for (int i = 1; i <= kJointSettled_ticks; ++i) {
    (void)bench.tick(bench.push(kAsked_n));
    if (std::abs(bench.reading().force_n - kAsked_n) > kBand_n) settled_ms = i;
  }
  return measured(fmt::format("step to {:g} N at {:.1f} deg", kAsked_n, angle_rad / kDegree),
                  fmt::format("{:.3f} N, within 2 % after {} ms", bench.reading().force_n, settled_ms),
                  "within 2 % after 1000 ms", settled_ms < 1000);
}

Check vent(const DeviceSpec& spec) {
  constexpr int kLimit_ms = 150;
  DeviceBench bench(spec);
  bench.make_ready();
  bench.ticks(kJointSettled_ticks, bench.push(spec.max_force_n / 2));
  const double held = bench.reading().force_n;
  bench.device().neutral();
  int after = 0;
  do {
    bench.silence();
    ++after;
  } while (bench.reading().force_n > 0.05 * held && after < 10 * kLimit_ms);
  return measured(fmt::format("neutral: vents from {:.1f} N to a twentieth", held), fmt::format("after {} ms", after),
                  fmt::format("{} ms", kLimit_ms), held > 0 && after <= kLimit_ms);
}

Check lost_finger(const DeviceSpec& spec) {
  DeviceBench bench(spec);
  bench.make_ready();
  bench.ticks(300, bench.push(spec.max_force_n / 2));
  bench.finger().put(kNaN);
  DeviceReading reading;
  DeviceStatus status = DeviceStatus::ok;
  int after = 0;
  while (status == DeviceStatus::ok && after < 100) {
    ++after;
    status = bench.device().read(bench.now_ns() + after * DeviceBench::kTick_ns, reading);
  }
  return measured("an angle that is not a number",
                  status == DeviceStatus::lost ? fmt::format("lost after {} ms", after) : "not noticed",
                  "lost after 2 ms", status == DeviceStatus::lost && after <= 2);
}

Check joint_rendering(const DeviceSpec& spec, double stiffness) {
  constexpr double kTolerance = 0.01, kFrequency_hz = 0.5;
  const TrackResult result = track(spec.finger, {.loop = {.gains = spec.gains, .tendon = spec.tendon},
                                                 .kobj_n_per_rad = stiffness,
                                                 .frequency_hz = kFrequency_hz});
  return measured(fmt::format("renders {:g} N/rad while it flexes at {:g} Hz", stiffness, kFrequency_hz),
                  fmt::format("{:.2f} N/rad", result.rendered_n_per_rad),
                  fmt::format("within {:g} %", 100 * kTolerance),
                  std::abs(result.rendered_n_per_rad - stiffness) <= kTolerance * stiffness);
}

}  // namespace

void check_joint(const DeviceSpec& spec, Checks& checks) {
  Checks own = {range(spec), stops(spec), encoder(spec), free_motion(spec)};
  for (const double share : {0.0, 0.5, 1.0})
    own.push_back(step(spec, spec.lowest_travel + share * (spec.highest_travel - spec.lowest_travel)));
  own.push_back(vent(spec));
  own.push_back(lost_finger(spec));
  for (const double stiffness : {8.0, 20.0, 50.0})  // the paper's softest, one between, and its stiffest
    if (stiffness <= spec.max_stiffness) own.push_back(joint_rendering(spec, stiffness));
  for (Check& check : own) {
    check.device = spec.name;
    checks.push_back(std::move(check));
  }
}

}  // namespace jnd
