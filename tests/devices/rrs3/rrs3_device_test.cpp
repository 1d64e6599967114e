// The simulated 3RRS device: its parts and what it renders.
#include "devices/rrs3/rrs3_device.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <rapidcheck.h>

#include "analysis/numerics/special_values.h"
#include "devices/loop/governor.h"
#include "devices/loop/rendering.h"
#include "devices/rrs3/rrs3_rendering.h"
#include "devices/rrs3/vibration_motor.h"
#include "protocols/input/input_error.h"
#include "tests/catch.h"
#include "tests/devices/device_fixtures.h"
#include "tests/units.h"

using namespace jnd;
using namespace jnd::testing;

// The simulated device settles to what was asked, and follows the normal within its speed.

namespace {

// Holds a command for some milliseconds, written every one, and returns the last reading.
DeviceReading hold(Rrs3Device& device, DeviceCommand command, std::int64_t& now, int milliseconds) {
  DeviceReading reading;
  for (int i = 0; i < milliseconds; ++i) {
    REQUIRE(device.read(now, reading) == DeviceStatus::ok);
    const Tilt tilt = tilt_toward(command.normal, reading.platform.sin_yaw, reading.platform.cos_yaw);
    command.roll_rad = tilt.roll_rad;
    command.pitch_rad = tilt.pitch_rad;
    REQUIRE(device.write(command, now) == DeviceStatus::ok);
    now += kMs;
  }
  REQUIRE(device.read(now, reading) == DeviceStatus::ok);
  return reading;
}

}  // namespace

TEST_CASE("a held penetration settles to the asked stiffness within one per cent, whatever the normal") {
  for (const double stiffness : {500.0, 600.0, 700.0, 900.0}) {
    for (const Eigen::Vector3d& lean : {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0.2, 0.1, 1),
                                        Eigen::Vector3d(-0.3, 0.4, 1), Eigen::Vector3d(0.1, -0.5, 1)}) {
      Rrs3Device device(rrs3_spec(), 1000);
      std::int64_t now = 0;
      (void)device.engage(now);
      DeviceCommand command;
      command.normal = lean.normalized();
      command.force_n = stiffness * 0.004;
      const DeviceReading reading = hold(device, command, now, 200);
      CHECK(reading.force_n / 0.004 == Approx(stiffness).epsilon(0.01));
      // The platform lies along the normal.
      const Rrs3Kinematics kinematics(geometry_of(rrs3_spec()));
      const auto at = kinematics.configuration({.pz_m = reading.platform.pz_m,
                                                .roll_rad = reading.platform.roll_rad,
                                                .pitch_rad = reading.platform.pitch_rad});
      REQUIRE(at);
      CHECK(at->rotation.col(2).dot(command.normal) > 1 - 1e-9);
      CHECK(device.torques().cwiseAbs().maxCoeff() > 1e-4);
    }
  }
}

TEST_CASE("the platform turns no faster than its joints") {
  const DeviceSpec spec = rrs3_spec();
  const Rrs3Kinematics kinematics(geometry_of(spec));
  Rrs3Device device(spec, 1000);
  std::int64_t now = 0;
  (void)device.engage(now);
  DeviceCommand command;
  command.roll_rad = spec.max_roll_rad;
  Eigen::Vector3d before = kinematics.joint_angles(*kinematics.configuration({.pz_m = spec.rest_z_m}));
  double fastest = 0;
  DeviceReading reading;
  int moving = 0;
  for (; moving < 200; ++moving) {
    (void)device.write(command, now);
    now += kMs;
    (void)device.read(now, reading);
    const Eigen::Vector3d q =
        kinematics.joint_angles(*kinematics.configuration({.pz_m = reading.platform.pz_m,
                                                           .roll_rad = reading.platform.roll_rad,
                                                           .pitch_rad = reading.platform.pitch_rad}));
    fastest = std::max(fastest, (q - before).cwiseAbs().maxCoeff() * 1000);
    before = q;
    if (reading.platform.roll_rad == spec.max_roll_rad) break;
  }
  CHECK(fastest <= spec.max_joint_speed_rad_per_s * 1.01);
  CHECK(fastest > spec.max_joint_speed_rad_per_s * 0.9);
  CHECK(moving > 30);  // 36 degrees take about 45 ms
  CHECK(moving < 100);
}

TEST_CASE("neutral is at once, and silence makes the device let go") {
  Rrs3Device device(rrs3_spec(), 1000);
  std::int64_t now = 0;
  (void)device.engage(now);
  DeviceCommand command;
  command.force_n = 3;
  command.vibration_g = 0.5;
  DeviceReading reading = hold(device, command, now, 100);
  CHECK(reading.force_n == Approx(3).epsilon(1e-6));
  CHECK(reading.vibration_g == 0.5);
  (void)device.read(now + 15 * kMs, reading);
  CHECK(reading.force_n == Approx(3).epsilon(1e-6));
  (void)device.read(now + 100 * kMs, reading);
  CHECK(reading.force_n < 1e-3);
  CHECK(reading.vibration_g == 0);
  now += 100 * kMs;
  reading = hold(device, command, now, 100);
  CHECK(reading.force_n > 2.9);
  device.neutral();
  (void)device.read(now, reading);
  CHECK(reading.force_n == 0);
  CHECK(reading.platform.pz_m == rrs3_spec().rest_z_m);
  CHECK(reading.platform.roll_rad == 0);
}

TEST_CASE("a pulp that would let the platform leave its stroke is refused") {
  CHECK_NOTHROW(Rrs3Device(rrs3_spec(), 700));
  CHECK_THROWS_AS(Rrs3Device(rrs3_spec(), 600), InputError);
  CHECK_THROWS_AS(Rrs3Device(rrs3_spec(), std::nan("")), InputError);
  DeviceSpec impossible = rrs3_spec();
  impossible.rest_z_m = -0.05;
  CHECK_THROWS_AS(Rrs3Device(impossible, 1000), InputError);
}

// What the 3RRS device renders on a finger, pressed through the governor as in a study.

TEST_CASE("wrench mode renders what is asked on a finger of 1000 N/m, within one per cent") {
  for (const double stiffness : {500.0, 600.0, 700.0, 900.0}) {
    const auto answer = measure_rendered_stiffness(rrs3_spec(), {.stiffness_n_per_m = stiffness});
    CHECK(answer.asked_n_per_m == stiffness);
    CHECK(answer.expected_n_per_m == stiffness);
    CHECK(answer.rendered_n_per_m == Approx(stiffness).epsilon(0.01));
    REQUIRE(answer.curve.size() == 10);
    for (std::size_t i = 1; i < answer.curve.size(); ++i) {
      CHECK(answer.curve[i].depth_m > answer.curve[i - 1].depth_m);
      CHECK(answer.curve[i].force_n > answer.curve[i - 1].force_n);
    }
    CHECK(answer.curve.back().force_n < 4.7);
  }
}

TEST_CASE("position control renders the series value, within 0.5 per cent, tilted too") {
  for (const double stiffness : {100.0, 500.0, 600.0, 700.0, 900.0, 2000.0}) {
    for (const double tilt : {0.0, 0.3}) {
      const auto answer = measure_rendered_stiffness(
          rrs3_spec(),
          {.stiffness_n_per_m = stiffness, .mode = RenderingMode::pd, .roll_rad = tilt, .pitch_rad = -tilt});
      CHECK(answer.expected_n_per_m == Approx(stiffness * 1000 / (stiffness + 1000)));
      CHECK(answer.rendered_n_per_m == Approx(answer.expected_n_per_m).epsilon(0.005));
    }
  }
  const auto firm = measure_rendered_stiffness(
      rrs3_spec(), {.stiffness_n_per_m = 500, .mode = RenderingMode::pd, .finger_n_per_m = 10000});
  CHECK(firm.rendered_n_per_m == Approx(476.19).epsilon(0.005));
}

TEST_CASE("the printed law departs from the series value the deeper the more") {
  const auto answer =
      measure_rendered_stiffness(rrs3_spec(), {.stiffness_n_per_m = 500, .mode = RenderingMode::pd_literal});
  CHECK(answer.expected_n_per_m == Approx(333.333).epsilon(1e-5));
  double before = 0;
  for (const DepthAndForce& point : answer.curve) {
    const double error = point.force_n / point.depth_m / answer.expected_n_per_m - 1;
    CHECK(error > before);
    before = error;
  }
  CHECK(before == Approx(0.054).margin(0.005));  // at 5 mm, where the platform hangs 3.2 mm behind
  CHECK(answer.rendered_n_per_m / answer.expected_n_per_m == Approx(1.038).margin(0.005));
}

TEST_CASE("what cannot be pressed is refused") {
  CHECK_THROWS_AS(measure_rendered_stiffness(rrs3_spec(), {.stiffness_n_per_m = 0}), InputError);
  CHECK_THROWS_AS(measure_rendered_stiffness(rrs3_spec(), {.stiffness_n_per_m = std::nan("")}), InputError);
  CHECK_THROWS_AS(measure_rendered_stiffness(rrs3_spec(), {.stiffness_n_per_m = 2001}), InputError);
  CHECK_THROWS_AS(measure_rendered_stiffness(rrs3_spec(), {.stiffness_n_per_m = 500, .finger_n_per_m = 100}),
                  InputError);
  CHECK_THROWS_AS(measure_rendered_stiffness(rrs3_spec(), {.stiffness_n_per_m = 500, .roll_rad = 1}), InputError);
  CHECK_THROWS_AS(measure_rendered_stiffness(rrs3_spec(), {.stiffness_n_per_m = 500, .depths = 0}), InputError);
}

// The force sensor: ideal by default; otherwise noise of the asked spread, steps, and a range.

TEST_CASE("a sensor without options says what is") {
  ForceSensor sensor;
  for (const double force : {0.0, -1.5, 1e-300, 4.7, 1e6}) CHECK(sensor.measure(force) == force);
  CHECK(std::isnan(sensor.measure(std::nan(""))));
}

TEST_CASE("the noise is Gaussian, of the asked SD, without bias or memory") {
  constexpr int kCount = 100000;
  ForceSensor sensor({.noise_sd_n = 0.02}, 42);
  std::vector<double> noise;
  for (int i = 0; i < kCount; ++i) noise.push_back(sensor.measure(3) - 3);
  double mean = 0, square = 0, fourth = 0, next = 0;
  int within = 0;
  for (int i = 0; i < kCount; ++i) {
    const double z = noise[static_cast<std::size_t>(i)] / 0.02;
    mean += z / kCount;
    square += z * z / kCount;
    fourth += z * z * z * z / kCount;
    within += std::abs(z) < 1;
    if (i > 0) next += z * noise[static_cast<std::size_t>(i) - 1] / 0.02 / kCount;
  }
  // Four standard errors.
  CHECK(std::abs(mean) < 4 / std::sqrt(kCount));
  CHECK(std::abs(square - 1) < 4 * std::sqrt(2.0 / kCount));
  CHECK(std::abs(fourth - 3) < 4 * std::sqrt(96.0 / kCount));
  CHECK(std::abs(next) < 4 / std::sqrt(kCount));
  CHECK(within / static_cast<double>(kCount) == Approx(0.6827).margin(4 * 0.0015));
}

TEST_CASE("the noise depends on seed and part alone") {
  const auto drawn = [](std::uint64_t seed, std::uint64_t part, int before) {
    ForceSensor sensor({.noise_sd_n = 1}, seed);
    for (int i = 0; i < before; ++i) (void)sensor.measure(0);
    sensor.begin(part);
    return std::vector<double>{sensor.measure(0), sensor.measure(0), sensor.measure(0)};
  };
  CHECK(drawn(1, 7, 0) == drawn(1, 7, 5));
  CHECK(drawn(1, 7, 0) != drawn(2, 7, 0));
  CHECK(drawn(1, 7, 0) != drawn(1, 8, 0));
}

TEST_CASE("steps are of the resolution, ends are of the range") {
  REQUIRE(rc::check("steps", [] {
    const double resolution = *rc::gen::element(0.001, 0.01, 0.25);
    ForceSensor sensor({.resolution_n = resolution});
    const double force = *rc::gen::inRange(-100000, 100001) / 12345.0;
    const double said = sensor.measure(force);
    RC_ASSERT(std::abs(said - force) <= resolution / 2 * (1 + 1e-9));
    RC_ASSERT(std::abs(said / resolution - std::round(said / resolution)) < 1e-6);
  }));
  ForceSensor sensor({.noise_sd_n = 0.5, .resolution_n = 0.3, .min_n = 0, .max_n = 5}, 3);
  for (int i = 0; i < 1000; ++i) {
    const double low = sensor.measure(0), high = sensor.measure(5);
    REQUIRE((low >= 0 && low <= 5));
    REQUIRE((high >= 0 && high <= 5));
  }
  CHECK(sensor.measure(1e9) == 5);
  CHECK(sensor.measure(kInf) == 5);
  CHECK(sensor.measure(-7) == 0);
}

TEST_CASE("an impossible sensor is refused") {
  CHECK_THROWS_AS(ForceSensor({.noise_sd_n = -0.1}), InputError);
  CHECK_THROWS_AS(ForceSensor({.noise_sd_n = std::nan("")}), InputError);
  CHECK_THROWS_AS(ForceSensor({.resolution_n = -1}), InputError);
  CHECK_THROWS_AS(ForceSensor({.min_n = 2, .max_n = 2}), InputError);
  CHECK_THROWS_AS(ForceSensor({.max_n = std::nan("")}), InputError);
}

// The vibration motor keeps to its range.

TEST_CASE("amplitude and frequency stay in the motor's range; 0 is off") {
  VibrationMotor motor;
  CHECK(motor.amplitude_g() == 0);
  motor.set(2, 300);
  CHECK(motor.amplitude_g() == 1);
  motor.set(0.01, 10);
  CHECK(motor.amplitude_g() == 0.05);
  motor.set(0.5, 200);
  CHECK(motor.amplitude_g() == 0.5);
  for (const double off : {0.0, -1.0, std::nan("")}) {
    motor.set(0.5, 200);
    motor.set(off, 200);
    CHECK(motor.amplitude_g() == 0);
  }
  motor.set(0.5, std::nan(""));
  CHECK(motor.amplitude_g() == 0);
  CHECK_THROWS_AS(VibrationMotor({.min_g = 1, .max_g = 0.5}), InputError);
  CHECK_THROWS_AS(VibrationMotor({.min_hz = -1}), InputError);
  CHECK_THROWS_AS(VibrationMotor({.max_hz = INFINITY}), InputError);
}
