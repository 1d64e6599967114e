// The firmware's states, its watchdog and which commands it takes, with telemetry as the only witness besides the
// actuators.
#include "devices/rrs3/rrs3_statics.h"
#include "tests/devices/hid/firmware/firmware_pressing.h"

using namespace jnd;
using namespace jnd::testing;

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
