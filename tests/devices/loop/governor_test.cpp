// Whatever is asked, what is given is safe.
#include "devices/loop/governor.h"

#include <cmath>

#include <rapidcheck.h>

#include "analysis/numerics/special_values.h"
#include "devices/loop/rendering.h"
#include "devices/mckibben/mckibben_device.h"
#include "devices/rrs3/rrs3_platform.h"
#include "protocols/input/input_error.h"
#include "protocols/rigs/device_models.h"
#include "tests/catch.h"
#include "tests/devices/device_fixtures.h"
#include "tests/units.h"

using namespace jnd;
using namespace jnd::testing;

namespace {

// The governor as a property: whatever is asked, whenever, what is given is safe.

GovernorInput push(double force, std::int64_t pose_time_ns) {
  GovernorInput input;
  input.asked.force_n = force;
  input.travel = -0.02;
  input.pose_time_ns = pose_time_ns;
  return input;
}

Governor active_governor() {
  Governor governor;
  governor.configure(rrs3_spec());
  governor.activate(0);
  return governor;
}

// Runs a constant ask every millisecond from t = 1 ms to the given one and returns the last output.
GovernorOutput hold(Governor& governor, double force, int from_ms, int to_ms) {
  GovernorOutput out;
  for (int t = from_ms; t <= to_ms; ++t) out = governor.govern(push(force, t * kMs), t * kMs);
  return out;
}

// Any double a broken host could send.
double wild() {
  switch (*rc::gen::inRange(0, 8)) {
    case 0:
      return std::nan("");
    case 1:
      return kInf;
    case 2:
      return -kInf;
    case 3:
      return 1e300;
    case 4:
      return -*rc::gen::inRange(0, 1000) / 100.0;
    default:
      return *rc::gen::inRange(0, 1000) / 100.0;
  }
}

TEST_CASE("whatever is asked, the given command is finite, within the limits, and rises slowly") {
  REQUIRE(rc::check("safe", [] {
    const DeviceSpec spec = rrs3_spec();
    Governor governor;
    governor.configure(spec);
    std::int64_t now = 0;
    double previous = 0;
    governor.activate(now);
    std::int64_t activated = now;
    for (int i = 0; i < 200; ++i) {
      const std::int64_t passed = *rc::gen::inRange(0, 25) == 0 ? 30 * kMs : *rc::gen::inRange(500'000, 3'000'000);
      now += passed;
      GovernorInput input = push(*rc::gen::inRange(0, 10) == 0 ? wild() : 3.0, now);
      if (*rc::gen::inRange(0, 20) == 0) input.asked.vibration_g = wild();
      if (*rc::gen::inRange(0, 20) == 0) input.asked.roll_rad = wild();
      if (*rc::gen::inRange(0, 20) == 0) input.travel = wild();
      if (*rc::gen::inRange(0, 20) == 0) input.pose_time_ns -= *rc::gen::inRange(0, 40) * kMs;
      const GovernorOutput out = governor.govern(input, now);
      const DeviceCommand& given = out.given;
      RC_ASSERT(given.force_n >= 0 && given.force_n <= spec.max_force_n);
      RC_ASSERT(given.force_n <= previous + 0.25 + 1e-12);
      RC_ASSERT(given.force_n <= spec.max_force_n * static_cast<double>(now - activated) / 200e6 + 1e-12);
      RC_ASSERT(std::abs(given.roll_rad) <= spec.max_roll_rad && std::abs(given.pitch_rad) <= spec.max_pitch_rad);
      RC_ASSERT(given.vibration_g >= 0 && given.vibration_g <= spec.max_vibration_g);
      RC_ASSERT(std::isfinite(given.normal.sum()));
      if (governor.state() != Governor::State::active) {
        RC_ASSERT(given.force_n == 0 && given.vibration_g == 0);
        RC_ASSERT(out.fault != Fault::none);
        governor.reset();
        governor.activate(now);
        activated = now;
      }
      previous = given.force_n;
    }
  }));
}

TEST_CASE("no force leaves a governor that is not active") {
  Governor governor;
  CHECK(governor.state() == Governor::State::unconfigured);
  CHECK_FALSE(governor.activate(0));
  CHECK(governor.govern(push(1, kMs), kMs).given.force_n == 0);
  governor.configure(rrs3_spec());
  CHECK(governor.state() == Governor::State::inactive);
  const GovernorOutput inactive = governor.govern(push(1, kMs), kMs);
  CHECK(inactive.given.force_n == 0);
  CHECK(inactive.force_reduced);
  CHECK((inactive.limits & limit::kNotActive) != 0);
  CHECK(governor.activate(0));
  CHECK(hold(governor, 1, 1, 300).given.force_n == 1);
  governor.deactivate();
  CHECK(governor.govern(push(1, 301 * kMs), 301 * kMs).given.force_n == 0);
}

TEST_CASE("the force is capped and the cap is told") {
  Governor governor = active_governor();
  const GovernorOutput out = hold(governor, 9, 1, 400);
  CHECK(out.given.force_n == 4.7);
  CHECK(out.force_reduced);
  CHECK(out.limits == limit::kForceCap);
  const GovernorOutput free = hold(governor, 4.6, 401, 402);
  CHECK(free.given.force_n == 4.6);
  CHECK_FALSE(free.force_reduced);
  CHECK(free.limits == 0);
}

TEST_CASE("a rising force is slowed to 250 N/s, a falling one passes at once") {
  Governor governor = active_governor();
  (void)hold(governor, 0, 1, 300);
  CHECK(hold(governor, 2, 301, 301).given.force_n == Approx(0.25));
  CHECK(hold(governor, 2, 302, 304).given.force_n == Approx(1.0));
  CHECK(hold(governor, 2, 305, 308).given.force_n == 2);
  CHECK(hold(governor, 0.1, 309, 309).given.force_n == 0.1);
  // After a late tick the rise is still that of one period.
  GovernorOutput late = governor.govern(push(2, 324 * kMs), 324 * kMs);
  CHECK(late.given.force_n == Approx(0.35));
  CHECK((late.limits & limit::kForceRise) != 0);
  CHECK(rise_limited_n(5, 1, -5) == 1);
  CHECK(rise_limited_n(0.5, 1, 0) == 0.5);
}

TEST_CASE("the force ramps up over 200 ms after engaging, and again after a pause") {
  CHECK(soft_start_gain(-1) == 0);
  CHECK(soft_start_gain(50 * kMs) == Approx(0.25));
  CHECK(soft_start_gain(200 * kMs) == 1);
  Governor governor = active_governor();
  const GovernorOutput ramp = hold(governor, 2, 1, 100);
  CHECK(ramp.given.force_n == Approx(1.0));
  CHECK(ramp.soft_start);
  CHECK(ramp.force_reduced);
  CHECK_FALSE(hold(governor, 2, 101, 200).soft_start);
  governor.deactivate();
  REQUIRE(governor.activate(200 * kMs));
  const GovernorOutput again = hold(governor, 2, 201, 220);
  CHECK(again.soft_start);
  CHECK(again.given.force_n == Approx(0.2));
}

TEST_CASE("an old pose, a gap between commands and a number that is none are faults, and stay so until reset") {
  const auto fault_of = [](auto&& disturb) {
    Governor governor = active_governor();
    (void)hold(governor, 2, 1, 300);
    GovernorInput input = push(2, 301 * kMs);
    std::int64_t now = 301 * kMs;
    disturb(input, now);
    const GovernorOutput out = governor.govern(input, now);
    if (out.fault == Fault::none) return out.fault;
    CHECK(out.given.force_n == 0);
    CHECK(governor.state() == Governor::State::faulted);
    const GovernorOutput next = governor.govern(push(2, now + kMs), now + kMs);
    CHECK(next.given.force_n == 0);
    CHECK(next.fault == out.fault);
    CHECK_FALSE(governor.activate(now));
    governor.reset();
    CHECK(governor.state() == Governor::State::inactive);
    return out.fault;
  };
  CHECK(fault_of([](GovernorInput& input, std::int64_t now) { input.pose_time_ns = now - 20 * kMs; }) == Fault::none);
  CHECK(fault_of([](GovernorInput& input, std::int64_t now) { input.pose_time_ns = now - 20 * kMs - 1; }) ==
        Fault::stale_pose);
  CHECK(fault_of([](GovernorInput& input, std::int64_t& now) { input.pose_time_ns = now = 321 * kMs; }) ==
        Fault::command_gap);
  CHECK(fault_of([](GovernorInput& input, std::int64_t& now) { input.pose_time_ns = now = 320 * kMs; }) == Fault::none);
  const double nan = std::nan("");
  CHECK(fault_of([&](GovernorInput& input, std::int64_t) { input.asked.force_n = nan; }) == Fault::non_finite);
  CHECK(fault_of([&](GovernorInput& input, std::int64_t) { input.asked.normal.y() = nan; }) == Fault::non_finite);
  CHECK(fault_of([&](GovernorInput& input, std::int64_t) { input.asked.vibration_g = nan; }) == Fault::non_finite);
  CHECK(fault_of([&](GovernorInput& input, std::int64_t) { input.travel = nan; }) == Fault::non_finite);
}

TEST_CASE("the platform can only push, inside its stroke, along a unit direction") {
  Governor governor = active_governor();
  (void)hold(governor, 0, 1, 300);
  const auto given = [&](int t, auto&& change) {
    GovernorInput input = push(0.2, t * kMs);
    change(input);
    return governor.govern(input, t * kMs);
  };
  CHECK(given(301, [](GovernorInput&) {}).given.force_n == 0.2);
  const GovernorOutput pull = given(302, [](GovernorInput& in) { in.asked.force_n = -1; });
  CHECK(pull.given.force_n == 0);
  CHECK(pull.limits == limit::kPull);
  CHECK(given(303, [](GovernorInput& in) { in.travel = -0.0124; }).limits == limit::kWorkspace);
  CHECK(given(304, [](GovernorInput& in) { in.asked.normal.z() = -1; }).given.force_n == 0);
  CHECK(given(305, [](GovernorInput& in) { in.asked.normal *= 3; }).given.force_n == 0);
  const GovernorOutput tilted = given(306, [](GovernorInput& in) { in.asked.roll_rad = 1; });
  CHECK(tilted.given.roll_rad == rrs3_spec().max_roll_rad);
  CHECK(tilted.limits == limit::kWorkspace);
  CHECK(tilted.given.force_n == 0.2);
}

TEST_CASE("vibration keeps to the motor's range and ends after 200 ms") {
  Governor governor = active_governor();
  const auto buzz = [&](int t, double g, double hz) {
    GovernorInput input = push(0, t * kMs);
    input.asked.vibration_g = g;
    input.asked.vibration_hz = hz;
    return governor.govern(input, t * kMs);
  };
  CHECK(buzz(1, 0.8, 200).given.vibration_g == 0.8);
  CHECK(buzz(2, 1.2, 200).given.vibration_g == 1.0);
  CHECK(buzz(3, 1.2, 200).limits == limit::kVibration);
  CHECK(buzz(4, 0.01, 200).given.vibration_g == 0.05);
  CHECK(buzz(5, 0.8, 900).given.vibration_hz == 240);
  for (int t = 6; t <= 200; ++t) CHECK(buzz(t, 0.8, 200).given.vibration_g == 0.8);
  CHECK(buzz(201, 0.8, 200).given.vibration_g == 0);
  CHECK(buzz(202, 0.8, 200).limits == limit::kBurst);
  CHECK(buzz(203, 0, 0).given.vibration_g == 0);
  CHECK(buzz(204, 0.8, 200).given.vibration_g == 0.8);  // a new burst
}

// Whatever a description says, and whatever is asked: no force above the model's hard limit, by the governor or past
// it.

// What the platform of the model, critically damped, passes beyond a commanded force while it settles.
constexpr double kOvershoot = 1.02;
constexpr double kHardPulp_n_per_m = 1e6;

class StillFinger final : public FingerFlexion {
 public:
  double angle_rad(std::int64_t /*time_ns*/) const noexcept override { return 0.6; }
};

// A described limit: far too large, no number, negative, or what the shipped file has.
double described(double shipped) {
  switch (*rc::gen::inRange(0, 7)) {
    case 0:
      return std::nan("");
    case 1:
      return kInf;
    case 2:
      return -shipped;
    case 3:
      return shipped / 2;
    case 4:
      return shipped;
    default:
      return shipped * *rc::gen::inRange(2, 1000);
  }
}

DeviceSpec any_description(const char* name) {
  DeviceSpec spec = shipped_rig(name).spec.devices.front();
  spec.max_force_n = described(spec.max_force_n);
  spec.max_roll_rad = described(spec.max_roll_rad);
  spec.max_pitch_rad = described(spec.max_pitch_rad);
  spec.max_stiffness = described(spec.max_stiffness);
  spec.min_vibration_g = described(spec.min_vibration_g);
  spec.max_vibration_g = described(spec.max_vibration_g);
  spec.min_vibration_hz = described(spec.min_vibration_hz);
  spec.max_vibration_hz = described(spec.max_vibration_hz);
  return spec;
}

DeviceCommand any_command() {
  DeviceCommand command;
  command.force_n = *rc::gen::inRange(0, 1000) / 10.0;
  command.vibration_g = *rc::gen::inRange(0, 100) / 10.0;
  command.vibration_hz = *rc::gen::inRange(0, 1000);
  command.roll_rad = *rc::gen::inRange(-100, 100) / 50.0;
  command.pitch_rad = *rc::gen::inRange(-100, 100) / 50.0;
  return command;
}

TEST_CASE("the shipped descriptions are as high as the hard limits, and no higher") {
  const DeviceSpec pulp = rrs3_spec();
  const HardLimits hard = hard_limits(DeviceModel::rrs3);
  CHECK(pulp.max_force_n == hard.force_n);
  CHECK(pulp.stroke_m == hard.stroke_m);
  CHECK(pulp.max_roll_rad == hard.roll_rad);
  CHECK(pulp.max_pitch_rad == hard.pitch_rad);
  CHECK(pulp.max_joint_speed_rad_per_s == hard.joint_speed_rad_per_s);
  CHECK(pulp.max_vibration_g == hard.vibration_g);
  CHECK(pulp.max_vibration_hz == hard.vibration_hz);
  CHECK(pulp.max_stiffness == hard.stiffness);
  const DeviceSpec joint = shipped_rig("mckibben").spec.devices.front();
  CHECK(joint.max_force_n == hard_limits(DeviceModel::mckibben).force_n);
  CHECK(joint.max_stiffness == hard_limits(DeviceModel::mckibben).stiffness);
}

TEST_CASE("the governor gives no more than the hard limits, whatever a description says") {
  for (const char* name : {"rrs3", "mckibben"})
    REQUIRE(rc::check("governed", [name] {
      const DeviceSpec spec = any_description(name);
      const HardLimits hard = hard_limits(spec.model);
      Governor governor;
      governor.configure(spec);
      governor.activate(0);
      for (std::int64_t now = kMs; now < 300 * kMs; now += kMs) {
        GovernorInput input;
        input.asked = any_command();
        input.travel = (spec.lowest_travel + spec.highest_travel) / 2;
        input.pose_time_ns = now;
        const DeviceCommand given = governor.govern(input, now).given;
        RC_ASSERT(given.force_n >= 0 && given.force_n <= hard.force_n);
        RC_ASSERT(given.vibration_g >= 0 && given.vibration_g <= std::max(hard.vibration_g, 0.0));
        RC_ASSERT(given.vibration_hz >= 0 && given.vibration_hz <= std::max(hard.vibration_hz, 0.0));
        RC_ASSERT(std::abs(given.roll_rad) <= hard.roll_rad);
        RC_ASSERT(std::abs(given.pitch_rad) <= hard.pitch_rad);
      }
    }));
}

TEST_CASE("the platform's joints turn no faster than the hard limit, and its stroke is no longer") {
  DeviceSpec faster = rrs3_spec(), longer = rrs3_spec();
  faster.max_joint_speed_rad_per_s *= 100;
  longer.stroke_m *= 100;
  Rrs3Platform at_limit(rrs3_spec(), 1000), described_faster(faster, 1000);
  for (int i = 0; i < 20; ++i) {
    at_limit.step({.roll_rad = 0.3, .pitch_rad = 0.3});
    described_faster.step({.roll_rad = 0.3, .pitch_rad = 0.3});
    CHECK(described_faster.coordinates().roll_rad == at_limit.coordinates().roll_rad);
    CHECK(described_faster.coordinates().pitch_rad == at_limit.coordinates().pitch_rad);
  }
  CHECK_THROWS_AS(Rrs3Platform(longer, 600), InputError);
}

TEST_CASE("past the governor the models' own caps hold, whatever a description says") {
  REQUIRE(rc::check("3RRS", [] {
    const HardLimits hard = hard_limits(DeviceModel::rrs3);
    // On a hard pulp the model is made for large described forces too; an infinite one it refuses.
    DeviceSpec spec = any_description("rrs3");
    if (std::isinf(spec.max_force_n)) spec.max_force_n = 100 * hard.force_n;
    Rrs3Device device(spec, kHardPulp_n_per_m);
    std::int64_t now = 0;
    (void)device.engage(now);
    DeviceCommand command = any_command();
    command.roll_rad = command.pitch_rad = 0;
    for (int i = 0; i < 200; ++i) {
      DeviceReading reading;
      (void)device.read(now, reading);
      (void)device.write(command, now);
      RC_ASSERT(reading.force_n <= hard.force_n * kOvershoot);
      RC_ASSERT(reading.vibration_g <= hard.vibration_g);
      now += kMs;
    }
  }));
  REQUIRE(rc::check("McKibben", [] {
    const StillFinger finger;
    MckibbenDevice device(mckibben_options(any_description("mckibben")), finger);
    MckibbenDevice at_cap(mckibben_options(shipped_rig("mckibben").spec.devices.front()), finger);
    std::int64_t now = 0;
    (void)device.engage(now);
    (void)at_cap.engage(now);
    DeviceCommand asked, most;
    asked.force_n = 1000;
    most.force_n = hard_limits(DeviceModel::mckibben).force_n;
    for (int i = 0; i < 100; ++i) {
      DeviceReading reading, reading_at_cap;
      (void)device.read(now, reading);
      (void)at_cap.read(now, reading_at_cap);
      RC_ASSERT(reading.force_n <= reading_at_cap.force_n + 1e-9);
      (void)device.write(asked, now);
      (void)at_cap.write(most, now);
      now += kMs;
    }
  }));
}

// What a contact asks of a device, whatever device it is: force, and the amplitude of a burst.

TEST_CASE("rendering laws (37) and (38)") {
  // Reference values: independent numpy model.
  CHECK(contact_force_n(500, 0.003) == Approx(1.5));
  CHECK(contact_force_n(1200, 0.003) == Approx(3.6));
  CHECK(burst_amplitude_g(0) == Approx(0.4));
  CHECK(burst_amplitude_g(500) == Approx(0.733333333333333));
  CHECK(burst_amplitude_g(900) == Approx(1.0));
  for (const double k : {100.0, 500.0, 900.0}) CHECK(stiffness_of_amplitude_n_per_m(burst_amplitude_g(k)) == Approx(k));
}

TEST_CASE("a damped contact resists going in, eases coming out, and never pulls") {
  CHECK(contact_force_n(500, 0.004, 0, 0.1) == contact_force_n(500, 0.004));
  CHECK(contact_force_n(500, 0.004, 2, 0.1) == Approx(2.2));
  CHECK(contact_force_n(500, 0.004, 2, -0.1) == Approx(1.8));
  CHECK(contact_force_n(500, 0.004, 2, -10) == 0);
  CHECK(contact_force_n(500, 0, 2, 10) == 0);  // no contact, no force
  const double nan = kNaN;
  CHECK(std::isnan(contact_force_n(500, nan, 2, 0)));
  CHECK(std::isnan(contact_force_n(500, 0.004, 2, nan)));
  // A closed stroke takes work from the finger: b times the integral of the squared speed.
  double work = 0;
  constexpr int kTicks = 10000;
  for (int i = 0; i < kTicks; ++i) {
    const double t = 2 * M_PI * (i + 0.5) / kTicks;  // period 1 s
    const double depth = 0.005 + 0.002 * std::sin(t), rate = 2 * M_PI * 0.002 * std::cos(t);
    work += contact_force_n(700, depth, 3, rate) * rate / kTicks;
  }
  CHECK(work == Approx(3 * std::pow(2 * M_PI * 0.002, 2) / 2));
}

}  // namespace
