// The firmware's states, faults and limits.
#include <cmath>

#include "devices/rrs3/rrs3_statics.h"
#include "tests/devices/hid/firmware/firmware_pressing.h"

using namespace jnd;
using namespace jnd::testing;

// The firmware's states, its watchdog and which commands it takes, with telemetry as the only witness besides the
// actuators.

namespace {

// The force of the last torques along z, by the C++ model, for a platform at rest.
double force_at_rest(const Board& board) {
  const auto at = board.model.configuration({.pz_m = board.model.geometry().rest_z_m});
  return force_along(*board.model.differential(*at),
                     {board.given.torque_n_m[0], board.given.torque_n_m[1], board.given.torque_n_m[2]}, {0, 0, 1});
}

}  // namespace

TEST_CASE("firmware: a device begins at rest, without a command, and tells so") {
  Board board;
  REQUIRE(board.power_up());
  CHECK(board.actuations == 0);
  const auto first = board.step();
  REQUIRE(first);
  CHECK(first->state == JND_STATE_REST);
  CHECK(first->sequence == 1);
  CHECK(first->command_sequence == 0);
  CHECK(first->command_age_us == JND_COMMAND_AGE_NONE);
  CHECK(first->faults == 0);
  CHECK(first->limits == 0);
  CHECK(first->rejected == 0);
  CHECK(first->time_us == board.now_us);
  CHECK(first->height_nm == Approx(-20'000'000).margin(20));
  CHECK(first->temperature_cdeg == 3000);
  CHECK(first->battery_percent == 80);
  CHECK(lets_go(board.given));
  const auto rest = joints_at(board.model, {.pz_m = -0.02});
  for (int leg = 0; leg < 3; ++leg) CHECK(board.given.joint_rad[leg] == Approx((*rest)[leg]).margin(1e-6));
  CHECK(board.step()->sequence == 2);
}

TEST_CASE("firmware: it presses with the law's force after the soft start") {
  Pressing device;
  CHECK(device.telemetry.state == JND_STATE_ACTIVE);
  CHECK(device.telemetry.limits == 0);
  CHECK(force_at_rest(device.board) == Approx(1.2).epsilon(1e-4));
  CHECK(device.telemetry.command_sequence == device.sequence);
  CHECK(device.telemetry.command_age_us == 1000);
}

TEST_CASE("firmware: soft start and rise bound the force from the first command on") {
  Board board;
  REQUIRE(board.power_up());
  board.step();
  std::uint32_t sequence = 0;
  board.give(pressing(++sequence, 2000, 0.01));
  const std::uint64_t active_us = board.now_us;
  double before = 0;
  for (int i = 0; i < 250; ++i) {
    const auto telemetry = board.step();
    const double force = force_at_rest(board);
    CHECK(force <= 4.7 * static_cast<double>(board.now_us - active_us) / 200e3 + 1e-4);
    CHECK(force <= before + 500 * 1e-3 + 1e-4);
    CHECK((telemetry->limits & JND_LIMIT_SOFT_START) == (i < 199 ? JND_LIMIT_SOFT_START : 0));
    before = force;
    board.give(pressing(++sequence, 2000, 0.01));
  }
  CHECK(before == Approx(4.7).epsilon(1e-4));
  // Away and back within the interval: at 500 N/s, ten steps to the cap.
  jnd_command away = pressing(++sequence, 2000, 0.01);
  away.touching = false;
  board.give(away);
  board.step();
  CHECK(force_at_rest(board) == 0);
  for (int i = 1; i <= 10; ++i) {
    board.give(pressing(++sequence, 2000, 0.01));
    const auto telemetry = board.step();
    CHECK(force_at_rest(board) == Approx(std::min(4.7, 0.5 * i)).epsilon(1e-4));
    CHECK((telemetry->limits & JND_LIMIT_RISE) == (i < 10 ? JND_LIMIT_RISE : 0));
  }
}

TEST_CASE("firmware: without commands the force is zero within the watchdog's time and a step") {
  Pressing device;
  const std::uint64_t last_us = device.board.now_us - 1000;  // the command came before the last step's millisecond
  std::uint64_t silent_us = 0;
  for (int i = 0; i < 40 && silent_us == 0; ++i) {
    const auto telemetry = device.board.step();
    if (torque_of(device.board) > 0) {
      CHECK(telemetry->state == JND_STATE_ACTIVE);
      continue;
    }
    silent_us = device.board.now_us - last_us;
    CHECK(telemetry->state == JND_STATE_STOPPED);
    CHECK(telemetry->faults == JND_FAULT_WATCHDOG);
  }
  CHECK(silent_us >= 20'000);
  CHECK(silent_us <= 21'000);
  // Stopped: commands are accepted, and change nothing.
  device.board.give(pressing(++device.sequence));
  auto telemetry = device.board.step();
  CHECK(telemetry->state == JND_STATE_STOPPED);
  CHECK(telemetry->command_sequence == device.sequence);
  CHECK(telemetry->rejected == 0);
  CHECK(lets_go(device.board.given));
  device.board.give_rest(++device.sequence);
  telemetry = device.board.step();
  CHECK(telemetry->state == JND_STATE_REST);
  CHECK(telemetry->faults == 0);
  device.board.give(pressing(++device.sequence));
  CHECK(device.board.step()->state == JND_STATE_ACTIVE);
}

TEST_CASE("firmware: rejected commands do not feed the watchdog") {
  Pressing device;
  std::uint8_t damaged[JND_REPORT_SIZE];
  const jnd_command next = pressing(device.sequence + 1), again = pressing(device.sequence);
  jnd_encode_command(&next, damaged);
  damaged[33] ^= 4;
  jnd_telemetry telemetry{};
  for (int i = 0; i < 25; ++i) {
    device.board.give(damaged, sizeof damaged);
    device.board.give(again);
    telemetry = *device.board.step();
  }
  CHECK(telemetry.state == JND_STATE_STOPPED);
  CHECK(telemetry.faults == JND_FAULT_WATCHDOG);
  CHECK(telemetry.rejected == 50);
  CHECK(telemetry.command_sequence == device.sequence);
}

TEST_CASE("firmware: a command that comes too late does not revive the force") {
  Pressing device;
  device.board.now_us += 30'000;  // the loop was held up
  device.board.give(pressing(++device.sequence));
  CHECK(lets_go(device.board.given));
  const auto telemetry = device.board.step(100);
  CHECK(telemetry->state == JND_STATE_STOPPED);
  CHECK(telemetry->faults == JND_FAULT_WATCHDOG);
}

TEST_CASE("firmware: mode rest takes the force away at once") {
  Pressing device;
  REQUIRE(torque_of(device.board) > 0);
  device.board.give_rest(++device.sequence);
  CHECK(lets_go(device.board.given));  // before the next step
  const auto telemetry = device.board.step();
  CHECK(telemetry->state == JND_STATE_REST);
  CHECK(telemetry->command_sequence == device.sequence);
  CHECK(lets_go(device.board.given));
  // The next pressing begins softly again.
  device.board.give(pressing(++device.sequence));
  CHECK((device.board.step()->limits & JND_LIMIT_SOFT_START) != 0);
}

TEST_CASE("firmware: commands are newer by serial numbers, and rest begins them anew") {
  Board board;
  REQUIRE(board.power_up());
  const auto echo_after = [&](std::uint32_t sequence) {
    board.give(pressing(sequence));
    return board.step()->command_sequence;
  };
  CHECK(echo_after(0) == 0);  // not newer than "none yet"
  CHECK(echo_after(0x80000000U) == 0);
  CHECK(board.step()->rejected == 2);
  CHECK(echo_after(0x7FFFFFFFU) == 0x7FFFFFFFU);
  CHECK(echo_after(0xFFFFFFF0U) == 0xFFFFFFF0U);
  CHECK(echo_after(0xFFFFFFF0U) == 0xFFFFFFF0U);
  CHECK(echo_after(0xFFFFFFEFU) == 0xFFFFFFF0U);
  CHECK(echo_after(5) == 5);
  CHECK(echo_after(0xFFFFFFF1U) == 5);
  CHECK(board.step()->rejected == 5);
  board.give_rest(0xFFFFFFF1U);
  CHECK(board.step()->command_sequence == 0xFFFFFFF1U);
  board.give_rest(3);
  CHECK(board.step()->command_sequence == 3);
  CHECK(echo_after(4) == 4);
  CHECK(board.step()->rejected == 5);
}

TEST_CASE("firmware: the age of a command is told as long as it fits") {
  Board board;
  REQUIRE(board.power_up());
  board.give_rest(7);
  CHECK(board.step(65'534)->command_age_us == 65'534);
  CHECK(board.step(1)->command_age_us == JND_COMMAND_AGE_NONE);
  CHECK(board.step(10)->command_age_us == JND_COMMAND_AGE_NONE);
  CHECK(board.step()->command_sequence == 7);
}

TEST_CASE("firmware: reports with another id, or none, are no commands") {
  Board board;
  REQUIRE(board.power_up());
  const ReportBytes unknown = {0x33, 1};
  board.give(unknown);
  board.give(unknown.data(), 0);
  CHECK(board.step()->rejected == 0);
  ReportBytes bytes{};
  const jnd_command command = pressing(1);
  jnd_encode_command(&command, bytes.data());
  board.give(bytes.data(), 63);
  CHECK(board.step()->rejected == 1);
  CHECK(board.step()->state == JND_STATE_REST);
}

// What stops the firmware or bounds what it does, and what it tells about itself.

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
