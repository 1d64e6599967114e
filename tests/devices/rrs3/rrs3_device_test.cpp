// The simulated device settles to what was asked, and follows the normal within its speed.
#include "devices/rrs3/rrs3_device.h"

#include <cmath>

#include "devices/loop/governor.h"
#include "devices/loop/rendering.h"
#include "protocols/input/input_error.h"
#include "tests/catch.h"
#include "tests/devices/device_fixtures.h"
#include "tests/units.h"

using namespace jnd;
using namespace jnd::testing;

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
