// The plant: alone, under the firmware, and with a tracker.
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <numbers>
#include <sstream>
#include <vector>

#include <nlohmann/json.hpp>
#include <rapidcheck.h>

#include "devices/hid/virtual/virtual_buttons.h"
#include "devices/hid/virtual/virtual_device.h"
#include "devices/hid/virtual/virtual_tracker.h"
#include "devices/loop/rendering.h"
#include "devices/rrs3/rrs3_device.h"
#include "devices/rrs3/rrs3_platform.h"
#include "protocols/input/input_error.h"
#include "tests/catch.h"
#include "tests/devices/hid/virtual/plant_fixtures.h"
#include "tests/units.h"

using namespace jnd;
using namespace jnd::testing;

namespace {

// The plant alone: what goes in as work is in the pulp, in motion or lost in the damper; and it settles where it
// should.

// m u'' + 2 sqrt(m k) u' + k u = F over a step, by Runge and Kutta's fourth order, and what the damper takes.
struct Motion {
  double u = 0, v = 0, lost_j = 0;
};
Motion integrated(Motion at, double force_n, double stiffness_n_per_m, double time_s) {
  const double damping = 2 * std::sqrt(kPlatformMass_kg * stiffness_n_per_m);
  const auto rate = [&](const Motion& x) {
    return Motion{x.v, (force_n - damping * x.v - stiffness_n_per_m * x.u) / kPlatformMass_kg, damping * x.v * x.v};
  };
  const auto plus = [](const Motion& x, double h, const Motion& d) {
    return Motion{x.u + h * d.u, x.v + h * d.v, x.lost_j + h * d.lost_j};
  };
  constexpr int kParts = 50;
  const double h = time_s / kParts;
  for (int part = 0; part < kParts; ++part) {
    const Motion a = rate(at), b = rate(plus(at, h / 2, a)), c = rate(plus(at, h / 2, b)), d = rate(plus(at, h, c));
    at = {at.u + h / 6 * (a.u + 2 * b.u + 2 * c.u + d.u), at.v + h / 6 * (a.v + 2 * b.v + 2 * c.v + d.v),
          at.lost_j + h / 6 * (a.lost_j + 2 * b.lost_j + 2 * c.lost_j + d.lost_j)};
  }
  return at;
}

// The joint torques that put a force on the platform along its normal, and no moment.
Eigen::Vector3d torques_for(const Rrs3Platform& platform, double force_n) {
  Wrench wrench = Wrench::Zero();
  wrench.head<3>() = force_n * platform.normal();
  return joint_torques(platform.differential(), wrench);
}

void turn_to(Rrs3Platform& platform, double roll_rad, double pitch_rad) {
  for (int i = 0; i < 300; ++i) platform.step({.roll_rad = roll_rad, .pitch_rad = pitch_rad});
  REQUIRE(platform.coordinates().roll_rad == Approx(roll_rad));
  REQUIRE(platform.coordinates().pitch_rad == Approx(pitch_rad));
}

struct Tilted {
  double roll_rad, pitch_rad;
};
constexpr Tilted kTilts[] = {{0, 0}, {0.3, 0}, {-0.2, 0.35}, {0.1, -0.5}};

TEST_CASE("the work of the joint torques is in the pulp, in motion or lost in the damper") {
  for (const Tilted& tilt : kTilts)
    for (const double pulp : {700.0, 1000.0, 3000.0}) {
      Rrs3Platform platform(plant_rrs3(), pulp);
      turn_to(platform, tilt.roll_rad, tilt.pitch_rad);
      double work_j = 0, lost_j = 0, most_j = 0;  // most_j: held at once
      double worst_u = 0, worst_v = 0, worst_j = 0;
      for (int ms = 0; ms < 600; ++ms) {
        // A press that swells, holds and lets go: at most 2.25 N.
        const double force = ms < 400 ? 1.5 + 0.75 * std::sin(0.01 * ms) : 0;
        const Eigen::Vector3d q = platform.joint_angles();
        const Eigen::Vector3d before = torques_for(platform, force);
        const Motion moved = integrated({platform.compression_m(), platform.velocity_m_per_s(), 0}, force, pulp, 0.001);
        platform.step({.force_n = platform.force_of(before), .roll_rad = tilt.roll_rad, .pitch_rad = tilt.pitch_rad});
        // The exact step is the differential equation's.
        worst_u = std::max(worst_u, std::abs(platform.compression_m() - moved.u));
        worst_v = std::max(worst_v, std::abs(platform.velocity_m_per_s() - moved.v));
        // Within the step the force stays the same while the lever arms change: the mean of both ends.
        work_j += (before + torques_for(platform, force)).dot(platform.joint_angles() - q) / 2;
        lost_j += moved.lost_j;
        const double u = platform.compression_m(), v = platform.velocity_m_per_s();
        const double held_j = pulp * u * u / 2 + kPlatformMass_kg * v * v / 2;
        most_j = std::max(most_j, held_j);
        worst_j = std::max(worst_j, std::abs(work_j - held_j - lost_j));
      }
      CHECK(worst_u < 1e-11);
      CHECK(worst_v < 1e-8);
      CHECK(worst_j < 2e-4 * most_j);
      CHECK(most_j > 1e-4);
      CHECK(platform.force_n() < 1e-9);
      CHECK(work_j == Approx(lost_j).margin(1e-3 * most_j));  // all is over
    }
}

TEST_CASE("a constant force settles at F / k, without overshoot") {
  CHECK(rc::check("whatever force, pulp and tilt", [] {
    const double pulp = *rc::gen::inRange(700, 5000);
    const double force = 1e-3 * *rc::gen::inRange(1, 4700);
    const double roll = 1e-3 * *rc::gen::inRange(-300, 300), pitch = 1e-3 * *rc::gen::inRange(-250, 250);
    Rrs3Platform platform(plant_rrs3(), pulp);
    const PlatformDrive drive{.force_n = force, .roll_rad = roll, .pitch_rad = pitch};
    for (int ms = 0; ms < 300; ++ms) {
      const double before = platform.force_n();
      platform.step(drive);
      RC_ASSERT(platform.force_n() >= before - 1e-12);
      RC_ASSERT(platform.force_n() <= force * (1 + 1e-12));
    }
    RC_ASSERT(std::abs(platform.force_n() / force - 1) < 1e-9);
    RC_ASSERT(std::abs(platform.coordinates().pz_m -
                       (plant_rrs3().rest_z_m + force / pulp / (std::cos(roll) * std::cos(pitch)))) < 1e-12);
  }));
}

TEST_CASE("a held position renders gain and pulp in series") {
  for (const double gain : {100.0, 500.0, 900.0, 2000.0})
    for (const double pulp : {700.0, 1000.0, 3000.0}) {
      Rrs3Platform platform(plant_rrs3(), pulp);
      constexpr double kDepth_m = 0.003;
      double worst_u = 0;
      for (int ms = 0; ms < 300; ++ms) {
        // Within the step the force falls by the gain, from what it was told.
        const double force = gain * (kDepth_m - platform.compression_m()), u = platform.compression_m();
        const Motion moved = integrated({u, platform.velocity_m_per_s(), 0}, force + gain * u, pulp + gain, 0.001);
        platform.step({.force_n = force, .hold_n_per_m = gain});
        worst_u = std::max(worst_u, std::abs(platform.compression_m() - moved.u));
      }
      CHECK(worst_u < 1e-11);
      CHECK(platform.force_n() == Approx(kDepth_m * gain * pulp / (gain + pulp)).epsilon(1e-9));
    }
}

TEST_CASE("whatever drives it, the platform neither pulls nor leaves its reach, and turns within its joints' speed") {
  CHECK(rc::check("hostile drives", [] {
    const DeviceSpec spec = plant_rrs3();
    Rrs3Platform platform(spec, 1000);
    const double joint_step = spec.max_joint_speed_rad_per_s * 1e-3;
    const int steps = *rc::gen::inRange(1, 200);
    double most_n = 0;
    for (int i = 0; i < steps; ++i) {
      PlatformDrive drive;
      drive.force_n = 1e-3 * *rc::gen::inRange(-20000, 20000);
      drive.hold_n_per_m = *rc::gen::element(0, 0, 500, 2000);
      drive.roll_rad = 1e-3 * *rc::gen::inRange(-1500, 1500);
      drive.pitch_rad = 1e-3 * *rc::gen::inRange(-1500, 1500);
      if (*rc::gen::inRange(0, 4) == 0) drive.force_n = 0;
      most_n = std::max(most_n, drive.force_n);
      const Eigen::Vector3d q = platform.joint_angles();
      const double u = platform.compression_m();
      platform.step(drive);
      RC_ASSERT(std::isfinite(platform.force_n()));
      RC_ASSERT(platform.force_n() >= 0);
      RC_ASSERT(platform.joint_angles().allFinite());
      // Turning alone, because a stroke moves the joints beside it; and within the tilts that a device allows. Towards
      // their corners the rates change by several per cent within a step.
      const Rrs3Coordinates& at = platform.coordinates();
      const bool allowed = std::abs(at.roll_rad) < spec.max_roll_rad && std::abs(at.pitch_rad) < spec.max_pitch_rad;
      if (u == 0 && platform.compression_m() == 0 && allowed)
        RC_ASSERT((platform.joint_angles() - q).cwiseAbs().maxCoeff() < 1.1 * joint_step);
      RC_ASSERT(platform.force_n() <= 1.5 * most_n);  // with the swing of a critically damped platform
    }
  }));
}

TEST_CASE("a platform at rest stays there to the last bit, and rest() brings it back") {
  Rrs3Platform platform(plant_rrs3(), 1000);
  const Eigen::Vector3d q = platform.joint_angles();
  for (int i = 0; i < 50; ++i) platform.step({});
  CHECK(platform.joint_angles() == q);
  CHECK(platform.force_n() == 0);
  for (int i = 0; i < 50; ++i) platform.step({.force_n = 2, .roll_rad = 0.2, .pitch_rad = -0.1});
  CHECK(platform.force_n() > 1.9);
  CHECK(platform.joint_angles() != q);
  platform.rest();
  CHECK(platform.joint_angles() == q);
  CHECK(platform.force_n() == 0);
  CHECK(platform.velocity_m_per_s() == 0);
}

TEST_CASE("a pulp too soft for the stroke is refused with the least stiffness that would do") {
  CHECK_THROWS_AS(Rrs3Platform(plant_rrs3(), 600), InputError);
  CHECK_THROWS_AS(Rrs3Platform(plant_rrs3(), -1), InputError);
  CHECK_THROWS_WITH(Rrs3Platform(plant_rrs3(), 600), Catch::Contains("at least 627"));
  DeviceSpec impossible = plant_rrs3();
  impossible.l2_m = 0.001;
  CHECK_THROWS_WITH(Rrs3Platform(impossible, 1000), Catch::Contains("rest pose"));
}

// The firmware in single precision on the plant against the model Rrs3Device in double precision: the same commands,
// to the units of the reports, must give the same forces.

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

// The virtual tracker and button box without a kernel, and the descriptors of all three.

TEST_CASE("the tracker's fingers close, press five millimetres three times, open and begin again") {
  Cable cable;
  VirtualTracker tracker({.rate_hz = 1000}, cable.end());
  RepeatedPresses motion(2);
  const auto cycle_ms = static_cast<int>(motion.cycle_ns() / kMs);
  for (int ms = 1; ms <= 2 * cycle_ms; ++ms) tracker.step(ms * kMs, false);
  const auto poses = cable.poses();
  REQUIRE(poses.size() == static_cast<std::size_t>(4 * cycle_ms));
  double deepest = 0, fastest = 0, widest = 0;
  int contacts = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    CHECK(poses[i].sequence == i + 1);
    CHECK(poses[i].seen);
    CHECK(poses[i].finger == (i % 2 == 0 ? JND_THUMB : JND_INDEX));
    const double depth = 0.040 - 1e-9 * std::abs(poses[i].position_nm[0]);
    deepest = std::max(deepest, depth);
    widest = std::max(widest, -depth);
    CHECK((poses[i].position_nm[0] < 0) == (poses[i].finger == JND_THUMB));
    if (i < 2) continue;
    const double before = 0.040 - 1e-9 * std::abs(poses[i - 2].position_nm[0]);
    fastest = std::max(fastest, std::abs(depth - before) / 0.001);
    if (i % 2 == 0 && before <= 0 && depth > 0) ++contacts;
  }
  CHECK(deepest == Approx(0.005).epsilon(1e-3));
  CHECK(widest == Approx(0.025).epsilon(1e-3));
  CHECK(fastest < 0.15);  // m/s: without a jump, at the end of a cycle neither
  CHECK(contacts == 6);
  // The same in the second cycle.
  for (std::size_t i = 0; i + 2 * static_cast<std::size_t>(cycle_ms) < poses.size(); ++i)
    if (motion.cycle_ns() % kMs == 0)
      REQUIRE(poses[i].position_nm[0] == poses[i + 2 * static_cast<std::size_t>(cycle_ms)].position_nm[0]);
}

TEST_CASE("the tracker loses its fingers, drops poses, and answers for itself") {
  Cable cable;
  VirtualTracker tracker({.fingers = {JND_MIDDLE}, .rate_hz = 100}, cable.end());
  CHECK(tracker.period_ns() == 10 * kMs);
  tracker.step(10 * kMs, false);
  CHECK(tracker.obey(parse_order("lose")));
  tracker.step(20 * kMs, false);
  CHECK(tracker.obey(parse_order("lose off")));
  CHECK(tracker.obey(parse_order("drop 1")));
  tracker.step(30 * kMs, false);
  tracker.step(40 * kMs, true);
  tracker.step(50 * kMs, false);
  const auto poses = cable.poses();
  REQUIRE(poses.size() == 3);
  CHECK(poses[0].finger == JND_MIDDLE);
  CHECK(poses[0].time_us == 10'000);
  CHECK_FALSE(poses[1].seen);
  CHECK(poses[2].sequence == 4);
  CHECK_FALSE(tracker.obey(parse_order("hot")));
  const auto ask = [&](std::uint8_t page, std::uint8_t operation) {
    jnd_request request{};
    request.operation = operation;
    request.page = page;
    Report bytes{};
    jnd_encode_request(&request, bytes.data());
    tracker.receive(bytes, 0);
    return cable.answers().back();
  };
  const jnd_answer identity_page = ask(JND_PAGE_IDENTITY, JND_READ_PAGE);
  CHECK(identity_page.result == JND_PAGE_OK);
  jnd_identity identity{};
  REQUIRE(jnd_decode_identity(identity_page.data, &identity));
  CHECK(identity.model == JND_MODEL_TRACKER);
  CHECK(identity.finger == JND_MIDDLE);
  CHECK(identity.loop_rate_hz == 100);
  CHECK(ask(JND_PAGE_LIMITS, JND_READ_PAGE).result == JND_PAGE_UNKNOWN);
  CHECK(ask(JND_PAGE_IDENTITY, JND_WRITE_PAGE).result == JND_PAGE_REFUSED);
  CHECK_THROWS_AS(RepeatedPresses(3), InputError);
  CHECK_THROWS_AS(VirtualTracker({.rate_hz = 0}, cable.end()), InputError);
  CHECK(nlohmann::json::parse("{" + tracker.status() + "}")["sent"] == 3);
}

TEST_CASE("the button box tells each change once") {
  Cable cable;
  VirtualButtons box("VB-1", cable.end());
  box.step(1, false);
  CHECK(cable.reports.empty());
  CHECK(box.obey(parse_order("button 1")));
  box.step(2, false);
  box.step(3, false);
  CHECK(box.obey(parse_order("button 8")));
  box.step(4, false);
  CHECK(box.obey(parse_order("button 1 off")));
  box.step(5, true);
  box.step(6, false);
  CHECK(cable.reports == std::vector<std::vector<std::uint8_t>>{{128, 128, 1}, {128, 128, 129}, {128, 128, 128}});
  CHECK_FALSE(box.obey(parse_order("hot")));
  CHECK(nlohmann::json::parse("{" + box.status() + "}")["buttons"] == 128);
}

TEST_CASE("the report descriptors are those of the protocol's page") {
  std::ifstream page(std::filesystem::path(JND_SOURCE_DIR) / "devices/hid/PROTOCOL.md");
  std::map<std::string, std::vector<std::uint8_t>> printed;
  std::string name;
  for (std::string line; std::getline(page, line);) {
    if (line.rfind("```", 0) == 0) {
      name = line.rfind("```descriptor ", 0) == 0 ? line.substr(14) : "";
    } else if (!name.empty()) {
      std::istringstream bytes(line.substr(0, 16));
      for (unsigned byte = 0; bytes >> std::hex >> byte;) printed[name].push_back(static_cast<std::uint8_t>(byte));
    }
  }
  CHECK(printed["fingertip"] == fingertip_descriptor());
  CHECK(printed["tracker"] == tracker_descriptor());
}

}  // namespace
