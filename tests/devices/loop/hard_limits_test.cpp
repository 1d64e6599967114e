// Whatever a description says, and whatever is asked: no force above the model's hard limit, by the governor or past
// it.
#include <cmath>

#include <rapidcheck.h>

#include "analysis/numerics/special_values.h"
#include "devices/loop/governor.h"
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

}  // namespace

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
