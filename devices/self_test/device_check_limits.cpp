// The limits of any device, measured: what the governor lets through, and what the device does by itself when a program
// goes wrong.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "analysis/numerics/special_values.h"
#include "devices/self_test/device_bench.h"

namespace jnd {

namespace {

constexpr int kAge_ticks = static_cast<int>(kMaxAge_ns / DeviceBench::kTick_ns);

std::string fault_text(Fault fault, double force_n) {
  return fmt::format("{}, {:g} N", to_string(fault), force_n);
}

Check no_force_before_active(DeviceBench bench) {
  bench.engage();
  double most_n = 0;
  bool told = true;
  for (int i = 0; i < 100; ++i) {
    const GovernorOutput& out = bench.tick(bench.push(bench.spec().max_force_n / 2));
    most_n = std::max(most_n, out.given.force_n);
    told = told && (out.limits & limit::kNotActive) != 0;
  }
  return measured("no force before it is activated", fmt::format("{:g} N", most_n), "0 N", most_n == 0 && told);
}

Check soft_start(DeviceBench bench) {
  bench.activate();
  const double asked_n = bench.spec().max_force_n / 2;
  const int wanted = static_cast<int>(kSoftStart_ns / DeviceBench::kTick_ns);
  bool above_ramp = false;
  int full = 0;
  for (int i = 1; i <= 10 * wanted && full == 0; ++i) {
    const double given = bench.tick(bench.push(asked_n)).given.force_n;
    above_ramp = above_ramp || given > asked_n * std::min(1.0, static_cast<double>(i) / wanted) * (1 + 1e-9);
    if (given >= asked_n) full = i;
  }
  return measured("soft start: half the largest force asked at once", fmt::format("there after {} ms", full),
                  fmt::format("{} ms, in a line", wanted), full >= wanted && !above_ramp);
}

Check force_rise(DeviceBench bench) {
  bench.make_ready();
  double before = 0, fastest = 0;
  for (int i = 0; i < 500; ++i) {
    const double given = bench.tick(bench.push(bench.spec().max_force_n)).given.force_n;
    fastest = std::max(fastest, (given - before) / (1e-9 * static_cast<double>(DeviceBench::kTick_ns)));
    before = given;
  }
  return measured("rise of the force", fmt::format("{:.1f} N/s", fastest),
                  fmt::format("at most {:g} N/s", kMaxForceRise_n_per_s),
                  fastest > 0 && fastest <= kMaxForceRise_n_per_s * (1 + 1e-9) && before == bench.spec().max_force_n);
}

Check force_cap(DeviceBench bench) {
  bench.make_ready();
  double most_given = 0;
  for (int i = 0; i < 500; ++i)
    most_given = std::max(most_given, bench.tick(bench.push(3 * bench.spec().max_force_n)).given.force_n);
  const double cap = bench.spec().max_force_n;
  return measured(fmt::format("force cap: {:g} N asked", 3 * cap), fmt::format("{:g} N commanded", most_given),
                  fmt::format("at most {:g} N", cap), most_given <= cap && most_given > 0.99 * cap);
}

// Settled: what is on the finger at the largest force that the governor gives.
Check force_on_finger(DeviceBench bench) {
  constexpr double kTolerance = 0.02;
  bench.make_ready();
  bench.ticks(1500, bench.push(3 * bench.spec().max_force_n));
  const double cap = bench.spec().max_force_n, force = bench.reading().force_n;
  return measured("force on the finger at the cap, settled", fmt::format("{:.3f} N", force),
                  fmt::format("{:g} N within {:g} %", cap, 100 * kTolerance),
                  std::abs(force - cap) <= kTolerance * cap);
}

Check no_pull(DeviceBench bench) {
  bench.make_ready();
  const GovernorOutput& out = bench.tick(bench.push(-1));
  return measured("a negative force asked", fmt::format("{:g} N", out.given.force_n), "0 N",
                  out.given.force_n == 0 && (out.limits & limit::kPull) != 0);
}

Check not_a_number(DeviceBench bench) {
  bench.make_ready();
  bench.ticks(300, bench.push(bench.spec().max_force_n / 2));
  const GovernorOutput out = bench.tick(bench.push(kNaN));
  return measured("a command that is not a number", fault_text(out.fault, out.given.force_n), "non_finite, 0 N",
                  out.fault == Fault::non_finite && out.given.force_n == 0);
}

Check not_a_number_past_the_governor(DeviceBench bench) {
  bench.make_ready();
  bench.ticks(500, bench.push(bench.spec().max_force_n / 2));
  const double held = bench.reading().force_n;
  for (int i = 0; i < 500; ++i) bench.write_raw(bench.push(kNaN));
  const double left = bench.reading().force_n;
  const double limit_n = 0.05 * held;
  return measured(fmt::format("the same past the governor, at {:.2f} N", held),
                  fmt::format("{:.3f} N after 0.5 s", left), fmt::format("at most {:.3f} N", limit_n),
                  held > 0 && std::abs(left) <= limit_n);
}

Check stale_pose(DeviceBench bench) {
  bench.make_ready();
  bench.ticks(300, bench.push(bench.spec().max_force_n / 2));
  int age = 0;  // ticks
  GovernorOutput out;
  while (out.fault == Fault::none && age < 10 * kAge_ticks) {
    ++age;
    out = bench.tick(bench.push(bench.spec().max_force_n / 2), age * DeviceBench::kTick_ns);
  }
  return measured("a finger that is no longer tracked",
                  fmt::format("{} after {} ms", fault_text(out.fault, out.given.force_n), age),
                  fmt::format("stale_pose, 0 N after {} ms + 1 tick", kAge_ticks),
                  out.fault == Fault::stale_pose && out.given.force_n == 0 && age <= kAge_ticks + 1);
}

Check command_gap(DeviceBench bench) {
  bench.make_ready();
  bench.ticks(300, bench.push(bench.spec().max_force_n / 2));
  for (int i = 0; i <= kAge_ticks; ++i) bench.silence();
  const GovernorOutput& out = bench.tick(bench.push(bench.spec().max_force_n / 2));
  return measured(fmt::format("a command {} ms after the last", kAge_ticks + 2),
                  fault_text(out.fault, out.given.force_n), "command_gap, 0 N",
                  out.fault == Fault::command_gap && out.given.force_n == 0);
}

Check watchdog(DeviceBench bench) {
  bench.make_ready();
  bench.ticks(500, bench.push(bench.spec().max_force_n / 2));
  const bool held = !bench.lets_go();
  int pushes = 0;  // milliseconds after the last command
  for (bench.silence(); !bench.lets_go() && pushes < 10 * kAge_ticks; bench.silence()) ++pushes;
  return measured("watchdog: without commands the device lets go", fmt::format("pushes {} ms more", pushes),
                  fmt::format("at most {} ms + 1 tick", kAge_ticks),
                  held && bench.lets_go() && pushes <= kAge_ticks + 1);
}

Check fault_holds(DeviceBench bench) {
  bench.make_ready();
  (void)bench.tick(bench.push(kNaN));
  Governor& governor = bench.governor();
  const bool refused = !governor.activate(bench.now_ns());
  const double force = bench.tick(bench.push(bench.spec().max_force_n / 2)).given.force_n;
  governor.reset();
  const bool again = governor.activate(bench.now_ns());
  return measured(
      "after a fault: nothing until it is reset",
      fmt::format("{}, {:g} N; {} after", refused ? "refused" : "activated", force, again ? "ready" : "not ready"),
      "refused, 0 N; ready after", refused && force == 0 && again);
}

}  // namespace

void check_limits(const DeviceSpec& spec, Checks& checks) {
  for (const auto check :
       {no_force_before_active, soft_start, force_rise, force_cap, force_on_finger, no_pull, not_a_number,
        not_a_number_past_the_governor, stale_pose, command_gap, watchdog, fault_holds}) {
    Check done = check(DeviceBench(spec));
    done.device = spec.name;
    checks.push_back(std::move(done));
  }
}

}  // namespace jnd
