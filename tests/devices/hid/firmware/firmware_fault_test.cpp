// What stops the firmware or bounds what it does, and what it tells about itself.
#include <cmath>

#include "devices/rrs3/rrs3_statics.h"
#include "tests/devices/hid/firmware/firmware_pressing.h"

using namespace jnd;
using namespace jnd::testing;

TEST_CASE("firmware: each fault stops it in the same step, and stays until mode rest finds its cause gone") {
  struct Case {
    const char* what;
    void (*cause)(Board&);
    unsigned fault;
  };
  const Case cases[] = {
      {"sensor silent", [](Board& b) { b.sensors.ok = false; }, JND_FAULT_SENSOR},
      {"joint not a number", [](Board& b) { b.sensors.joint_rad[1] = NAN; }, JND_FAULT_SENSOR},
      {"temperature infinitely low", [](Board& b) { b.sensors.temperature_c = -INFINITY; }, JND_FAULT_SENSOR},
      {"force infinite", [](Board& b) { b.sensors.force_n = INFINITY; }, JND_FAULT_SENSOR},
      {"vibration not a number", [](Board& b) { b.sensors.vibration_g = NAN; }, JND_FAULT_SENSOR},
      {"battery's figure impossible", [](Board& b) { b.sensors.battery_percent = 130; }, JND_FAULT_SENSOR},
      {"hot", [](Board& b) { b.sensors.temperature_c = 60.1F; }, JND_FAULT_TEMPERATURE},
      {"battery", [](Board& b) { b.sensors.battery_percent = 4; }, JND_FAULT_BATTERY},
      {"stop button", [](Board& b) { b.sensors.stop_button = true; }, JND_FAULT_BUTTON},
      {"pose out of reach", [](Board& b) { b.sensors.joint_rad[0] = 2.5F; }, JND_FAULT_INTERNAL},
  };
  for (const Case& one : cases) {
    INFO(one.what);
    Pressing device;
    const jnd_sensors healthy = device.board.sensors;
    one.cause(device.board);
    device.board.give(pressing(++device.sequence));
    auto telemetry = device.board.step();
    REQUIRE(telemetry);
    CHECK(telemetry->state == JND_STATE_STOPPED);
    CHECK(telemetry->faults == one.fault);
    CHECK(lets_go(device.board.given));
    // The cause is still there: no way back to force.
    device.board.give_rest(++device.sequence);
    telemetry = device.board.step();
    CHECK(telemetry->state == JND_STATE_REST);
    CHECK(telemetry->faults == one.fault);
    device.board.give(pressing(++device.sequence));
    CHECK(device.board.step()->state == JND_STATE_REST);
    // Not even between two steps.
    device.board.give_rest(++device.sequence);
    device.board.give(pressing(++device.sequence));
    CHECK(device.board.step()->state == JND_STATE_REST);
    // Gone, but still latched.
    device.board.sensors = healthy;
    device.board.give(pressing(++device.sequence));
    telemetry = device.board.step();
    CHECK(telemetry->state == JND_STATE_REST);
    CHECK(telemetry->faults == one.fault);
    device.board.give_rest(++device.sequence);
    CHECK(device.board.step()->faults == 0);
    device.board.give(pressing(++device.sequence));
    CHECK(device.board.step()->state == JND_STATE_ACTIVE);
  }
}

TEST_CASE("firmware: what is not measured is no fault") {
  Board board;
  REQUIRE(board.power_up());
  board.sensors.temperature_c = NAN;
  board.sensors.battery_percent = 255;
  auto telemetry = board.step();
  REQUIRE(telemetry);
  CHECK(telemetry->faults == 0);
  CHECK(telemetry->temperature_cdeg == JND_TEMPERATURE_NONE);
  CHECK(telemetry->battery_percent == JND_BATTERY_NONE);
  // Nor is what is just within its bounds.
  board.sensors.temperature_c = 60;
  board.sensors.battery_percent = 5;
  telemetry = board.step();
  CHECK(telemetry->faults == 0);
  CHECK(telemetry->temperature_cdeg == 6000);
  CHECK(telemetry->battery_percent == 5);
}

TEST_CASE("firmware: a clock that runs backwards stops it") {
  Pressing device;
  device.board.now_us -= 5000;
  device.board.give(pressing(++device.sequence));
  const auto telemetry = device.board.step(0);
  CHECK(telemetry->state == JND_STATE_STOPPED);
  CHECK(telemetry->faults != 0);
  CHECK(lets_go(device.board.given));
}

TEST_CASE("firmware: outside its range of heights it gives no force") {
  Pressing device;
  device.board.place({.pz_m = -0.01249});
  device.board.give(pressing(++device.sequence));
  auto telemetry = device.board.step();
  CHECK(telemetry->state == JND_STATE_ACTIVE);
  CHECK(telemetry->limits == JND_LIMIT_WORKSPACE);
  CHECK(torque_of(device.board) == 0);
  // Resting on the stop is inside.
  device.board.place({.pz_m = -0.0125});
  device.board.give(pressing(++device.sequence));
  telemetry = device.board.step();
  CHECK((telemetry->limits & JND_LIMIT_WORKSPACE) == 0);
  CHECK(torque_of(device.board) > 0);
  // Twisted far beyond its tilt.
  device.board.place({.pz_m = -0.02, .roll_rad = 0.7});
  device.board.give(pressing(++device.sequence));
  telemetry = device.board.step();
  CHECK(telemetry->limits == JND_LIMIT_WORKSPACE);
  CHECK(torque_of(device.board) == 0);
}

TEST_CASE("firmware: position control neither pulls nor turns harder than the device's cap allows") {
  for (const int mode : {JND_MODE_PD, JND_MODE_PD_LITERAL}) {
    Board board;
    REQUIRE(board.power_up());
    board.step();
    const Rrs3Coordinates deep{.pz_m = -0.013}, askew{.pz_m = -0.02, .roll_rad = 0.5, .pitch_rad = -0.4};
    const auto torques_at = [&](const Rrs3Coordinates& xi, double depth_m) {
      board.place(xi);
      jnd_command command = pressing(board.device.command.sequence + 1, 2000, depth_m);
      command.mode = static_cast<std::uint8_t>(mode);
      board.give(command);
      CHECK(board.step()->state == JND_STATE_ACTIVE);
      return Eigen::Vector3d(board.given.torque_n_m[0], board.given.torque_n_m[1], board.given.torque_n_m[2]);
    };
    const auto rates_at = [&](const Rrs3Coordinates& xi) {
      return *board.model.differential(*board.model.configuration(xi));
    };
    // 7 mm too deep, at 2000 N/m: it would be drawn back with 14 N.
    CHECK(force_along(rates_at(deep), torques_at(deep, 1e-5), {0, 0, 1}) == Approx(-4.7).epsilon(1e-3));
    // 0.6 rad askew at 2 N m/rad would be 1.2 N m; 4.7 N at the platform's edge are 0.047 N m.
    const double moment = (rates_at(askew).j.transpose() * torques_at(askew, 1e-5)).tail<2>().norm();
    CHECK(moment > 0.01);
    CHECK(moment < 0.06);
  }
}

TEST_CASE("firmware: tilt follows the command, touching or not, as angles and as joints") {
  Board board;
  REQUIRE(board.power_up());
  board.place({.pz_m = -0.0185});
  jnd_command command{};
  command.sequence = 1;
  command.mode = JND_MODE_WRENCH;
  command.roll_dmrad = 3000;
  command.pitch_dmrad = -1500;
  board.give(command);
  CHECK(board.step()->limits == 0);
  CHECK(board.given.roll_rad == Approx(0.3));
  CHECK(board.given.pitch_rad == Approx(-0.15));
  const auto joints = joints_at(board.model, {.pz_m = -0.0185, .roll_rad = 0.3, .pitch_rad = -0.15});
  for (int leg = 0; leg < 3; ++leg) CHECK(board.given.joint_rad[leg] == Approx((*joints)[leg]).margin(1e-5));
}

TEST_CASE("firmware: telemetry tells the pose that the joints stand for") {
  Board board;
  REQUIRE(board.power_up());
  const Rrs3Coordinates xi{.pz_m = -0.0187, .roll_rad = 0.31, .pitch_rad = -0.22};
  board.place(xi);
  board.sensors.force_n = 1.234567F;
  board.sensors.vibration_g = 0.35F;
  board.sensors.buttons = 0xA5;
  const auto telemetry = board.step();
  REQUIRE(telemetry);
  CHECK(telemetry->height_nm == Approx(-18'700'000).margin(50));
  CHECK(telemetry->roll_dmrad == 3100);
  CHECK(telemetry->pitch_dmrad == -2200);
  CHECK(telemetry->yaw_dmrad == Approx(1e4 * yaw_of(*board.model.pose(xi))).margin(1));
  CHECK(telemetry->force_un == 1234567);
  CHECK(telemetry->vibration_mg == 350);
  CHECK(telemetry->buttons == 0xA5);
  const auto joints = joints_at(board.model, xi);
  for (int leg = 0; leg < 3; ++leg) CHECK(telemetry->joint_urad[leg] == Approx(1e6 * (*joints)[leg]).margin(1));
}

TEST_CASE("firmware: readings beyond their type are told as the nearest that it holds") {
  Board board;
  REQUIRE(board.power_up());
  board.sensors.force_n = -1e20F;
  board.sensors.vibration_g = 1e9F;
  board.sensors.temperature_c = -4000;
  auto telemetry = board.step();
  REQUIRE(telemetry);
  CHECK(telemetry->force_un == INT32_MIN);
  CHECK(telemetry->vibration_mg == 65535);
  CHECK(telemetry->temperature_cdeg == -32767);
  board.sensors.force_n = 3e38F;
  board.sensors.vibration_g = -1;
  telemetry = board.step();
  CHECK(telemetry->force_un == INT32_MAX);
  CHECK(telemetry->vibration_mg == 0);
}

TEST_CASE("firmware: telemetry without room leaves a gap in its numbers") {
  Board board;
  REQUIRE(board.power_up());
  CHECK(board.step()->sequence == 1);
  board.room = false;
  CHECK_FALSE(board.step());
  CHECK_FALSE(board.step());
  board.room = true;
  CHECK(board.step()->sequence == 4);
}

TEST_CASE("firmware: a geometry that cannot hold its rest pose stays stopped, and still answers") {
  jnd_fingertip_config config = jnd_fingertip_default_config("TEST-1", JND_INDEX);
  config.geometry.rest_height_nm = -60'000'000;
  // A fixture of the shipped geometry around a device of the impossible one.
  Board board;
  board.config = config;
  CHECK_FALSE(board.power_up());
  auto telemetry = board.step();
  REQUIRE(telemetry);
  CHECK(telemetry->state == JND_STATE_STOPPED);
  CHECK(telemetry->faults == JND_FAULT_INTERNAL);
  board.give_rest(1);
  board.give(pressing(2));
  telemetry = board.step();
  CHECK(telemetry->state == JND_STATE_STOPPED);
  CHECK(telemetry->faults == JND_FAULT_INTERNAL);
  CHECK(lets_go(board.given));
  CHECK(board.ask(JND_PAGE_IDENTITY)->result == JND_PAGE_OK);
}

TEST_CASE("firmware: pages that no host would accept are no configuration") {
  const auto sound = [](auto change) {
    Board board;
    change(board.config);
    return board.power_up();
  };
  CHECK(sound([](jnd_fingertip_config&) {}));
  CHECK_FALSE(sound([](jnd_fingertip_config& config) { config.identity.serial[0] = 0; }));
  CHECK_FALSE(sound([](jnd_fingertip_config& config) { config.identity.watchdog_ms = 0; }));
  CHECK_FALSE(sound([](jnd_fingertip_config& config) { config.limits.lowest_height_nm = 0; }));
  CHECK_FALSE(sound([](jnd_fingertip_config& config) { config.geometry.l2_nm = 0; }));
}
