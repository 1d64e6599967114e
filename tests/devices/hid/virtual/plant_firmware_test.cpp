// The firmware in single precision on the plant against the model Rrs3Device in double precision: the same commands,
// to the units of the reports, must give the same forces.
#include <cmath>
#include <limits>
#include <numbers>

#include "devices/loop/rendering.h"
#include "devices/rrs3/rrs3_device.h"
#include "tests/catch.h"
#include "tests/devices/hid/virtual/plant_fixtures.h"
#include "tests/units.h"

using namespace jnd;
using namespace jnd::testing;

namespace {

// Measured over the cases below: 1.6e-6 N in wrench mode, 3.7e-6 N in pd, 3.8e-6 N in pd_literal, 1.1e-6 rad; a unit of
// the reports is 1e-6 N. Bounds with room for another compiler's rounding; of the cap they are two millionths.
constexpr double kBound_n = 1e-5, kBound_rad = 5e-6;

struct Course {
  double stiffness_n_per_m = 0;
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double depth_m = 0.004;
  double press_hz = 1;
};

struct Difference {
  double most_force_n = 0, most_tilt_rad = 0, deepest_force_n = 0;
  bool sound = true;  // active all the time, and none of the firmware's own limits acted but soft start, tilt and cap
};

jnd_command command_of(const Course& course, std::uint32_t sequence, std::uint8_t mode, double depth_m, Tilt tilt) {
  jnd_command command = press_command(sequence, course.stiffness_n_per_m, depth_m);
  command.mode = mode;
  command.touching = depth_m > 0;
  for (int axis = 0; axis < 3; ++axis)
    command.normal[axis] = static_cast<std::int32_t>(std::lround(course.normal[axis] * double{JND_NORMAL_ONE}));
  command.roll_dmrad = static_cast<std::int16_t>(std::lround(1e4 * tilt.roll_rad));
  command.pitch_dmrad = static_cast<std::int16_t>(std::lround(1e4 * tilt.pitch_rad));
  if (!command.touching) command.penetration_nm = command.stiffness_mn_per_m = 0;
  if (!command.touching) command.normal[0] = command.normal[1] = command.normal[2] = 0;
  return command;
}

// What the model is told: the numbers that are left in the report.
DeviceCommand model_command(const Course& course, const jnd_command& report) {
  DeviceCommand command;
  command.stiffness_n_per_m = 1e-3 * report.stiffness_mn_per_m;
  command.force_n = std::min(command.stiffness_n_per_m * 1e-9 * report.penetration_nm, 4.7);
  command.normal = course.normal;
  command.roll_rad = 1e-4 * report.roll_dmrad;
  command.pitch_rad = 1e-4 * report.pitch_dmrad;
  return command;
}

Difference compare(const Course& course, RenderingMode mode, std::uint8_t report_mode, double pulp) {
  Rrs3Device model(plant_rrs3(), {.pulp_stiffness_n_per_m = pulp, .mode = mode});
  FirmwareOnPlant device(pulp);
  REQUIRE(device.sound);
  (void)model.engage(0);
  Difference out;
  DeviceReading reading;
  for (int ms = 0; ms < 2300; ++ms) {
    // 300 ms without contact, for the soft start; then presses of half a sine, from the surface and back.
    const double phase = 2 * std::numbers::pi * course.press_hz * 1e-3 * (ms - 300);
    const double depth = ms < 300 ? 0 : course.depth_m * std::max(std::sin(phase), 0.0);
    const Tilt tilt = tilt_toward(course.normal, reading.platform.sin_yaw, reading.platform.cos_yaw);
    const jnd_command report = command_of(course, static_cast<std::uint32_t>(ms + 1), report_mode, depth, tilt);
    (void)model.write(model_command(course, report), ms * kMs);
    device.receive(report);
    device.step();
    (void)model.read((ms + 1) * kMs, reading);
    const unsigned others = ~unsigned{JND_LIMIT_SOFT_START | JND_LIMIT_TILT | JND_LIMIT_FORCE};
    out.sound = out.sound && device.telemetry.state == JND_STATE_ACTIVE && (device.telemetry.limits & others) == 0;
    out.most_force_n = std::max(out.most_force_n, std::abs(device.board.force_n() - reading.force_n));
    out.deepest_force_n = std::max(out.deepest_force_n, reading.force_n);
    out.most_tilt_rad = std::max(
        {out.most_tilt_rad, std::abs(device.board.platform().coordinates().roll_rad - reading.platform.roll_rad),
         std::abs(device.board.platform().coordinates().pitch_rad - reading.platform.pitch_rad)});
  }
  return out;
}

}  // namespace

TEST_CASE("firmware and plant give the forces of the model, in every rendering mode") {
  const struct {
    RenderingMode mode;
    std::uint8_t report_mode;
    const char* name;
  } modes[] = {{RenderingMode::wrench, JND_MODE_WRENCH, "wrench"},
               {RenderingMode::pd, JND_MODE_PD, "pd"},
               {RenderingMode::pd_literal, JND_MODE_PD_LITERAL, "pd_literal"}};
  for (const auto& mode : modes) {
    double most_n = 0, most_tilt_rad = 0;
    for (const double stiffness : {500.0, 700.0, 900.0, 1500.0})
      for (const Eigen::Vector3d& lean : {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0.2, 0.1, 1),
                                          Eigen::Vector3d(-0.3, 0.4, 1), Eigen::Vector3d(0.1, -0.5, 1)})
        for (const double pulp : {1000.0, 2500.0}) {
          const Course course{.stiffness_n_per_m = stiffness, .normal = lean.normalized()};
          const Difference found = compare(course, mode.mode, mode.report_mode, pulp);
          CHECK(found.sound);
          CHECK(found.deepest_force_n > 1.2);
          most_n = std::max(most_n, found.most_force_n);
          most_tilt_rad = std::max(most_tilt_rad, found.most_tilt_rad);
        }
    INFO(mode.name << ": forces differ by at most " << most_n << " N, tilts by " << most_tilt_rad << " rad");
    CHECK(most_n < kBound_n);
    CHECK(most_tilt_rad < kBound_rad);
  }
}

TEST_CASE("a fast press of 5 mm is followed as by the model until the force's own limit") {
  const Course course{.stiffness_n_per_m = 900, .depth_m = 0.005, .press_hz = 4};
  const Difference found = compare(course, RenderingMode::wrench, JND_MODE_WRENCH, 1000);
  CHECK(found.deepest_force_n > 4.3);
  CHECK(found.most_force_n < kBound_n);
}

TEST_CASE("the firmware tells the plant's own force, height, tilt and joints") {
  FirmwareOnPlant device;
  for (std::uint32_t ms = 0; ms < 600; ++ms) {
    jnd_command command = press_command(ms + 1, 700, 0.004);
    command.roll_dmrad = 1500;
    command.pitch_dmrad = -800;
    device.receive(command);
    device.step();
  }
  const Rrs3Platform& platform = device.board.platform();
  CHECK(1e-6 * device.telemetry.force_un == Approx(platform.force_n()).margin(2e-6));
  CHECK(1e-9 * device.telemetry.height_nm == Approx(platform.coordinates().pz_m).margin(2e-8));
  CHECK(1e-4 * device.telemetry.roll_dmrad == Approx(platform.coordinates().roll_rad).margin(6e-5));
  CHECK(1e-4 * device.telemetry.pitch_dmrad == Approx(platform.coordinates().pitch_rad).margin(6e-5));
  CHECK(1e-4 * device.telemetry.yaw_dmrad == Approx(yaw_of(platform.configuration())).margin(6e-5));
  for (int joint = 0; joint < 3; ++joint)
    CHECK(1e-6 * device.telemetry.joint_urad[joint] == Approx(platform.joint_angles()[joint]).margin(2e-6));
  CHECK(device.telemetry.temperature_cdeg == 3100);
  CHECK(device.telemetry.battery_percent == JND_BATTERY_NONE);
}

TEST_CASE("torques that stay the same press as the lever arms of the present pose let them") {
  const FirmwareOnPlant device;
  PlantHardware board(plant_spec_of(device.config), 1000, [](auto) { return true; });
  jnd_hardware hardware = board.functions();
  Wrench wrench = Wrench::Zero();
  wrench[2] = 3;
  const Eigen::Vector3d torques = joint_torques(board.platform().differential(), wrench);
  jnd_actuation actuation{};
  for (int joint = 0; joint < 3; ++joint) actuation.torque_n_m[joint] = static_cast<float>(torques[joint]);
  hardware.actuate(hardware.context, &actuation);
  CHECK(board.push_n() == Approx(3).epsilon(1e-6));
  for (int ms = 0; ms < 300; ++ms) board.advance();
  CHECK(board.push_n() == Approx(board.platform().force_of(torques)).epsilon(1e-6));
  CHECK(board.force_n() == Approx(board.push_n()).epsilon(1e-6));
  CHECK(std::abs(board.push_n() - 3) > 0.1);  // 3 mm in, the arms are others

  actuation.torque_n_m[1] = std::numeric_limits<float>::quiet_NaN();
  hardware.actuate(hardware.context, &actuation);
  CHECK(board.push_n() == 0);
  CHECK(board.impossible() == 1);
  for (int ms = 0; ms < 60; ++ms) board.advance();
  CHECK(board.force_n() < 1e-3);
}
