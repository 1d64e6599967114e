// Whatever a host sends and the sensors say, the firmware asks nothing of its actuators that its limits forbid.
//
// A run is a list of deeds: commands with arbitrary fields, replays, noise, damaged bits, pages, silence, stalls and
// jumps of time, and sensors that say what they like. The judge keeps its own books of what was accepted, and knows the
// torques' effect from the C++ model; it does not look at the firmware's laws.
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <type_traits>

#include <rapidcheck.h>

#include "devices/rrs3/rrs3_statics.h"
#include "tests/catch.h"
#include "tests/devices/hid/firmware/firmware_judge.h"

using namespace jnd;
using namespace jnd::testing;

namespace {

using Random = std::mt19937_64;

// What a deed is; its particulars come from its seed.
enum class Deed : int { press, anything, rest, replay, noise, damage, page, silence, stall, jump, burst, sense, weird };
constexpr int kDeeds = 13;

double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}
// Drawn as 64 bits: the standard knows no distribution of bytes.
template <typename T>
T integer(Random& random, T low, T high) {
  using Wide = std::conditional_t<std::is_signed_v<T>, long long, unsigned long long>;
  return static_cast<T>(std::uniform_int_distribution<Wide>(low, high)(random));
}
bool chance(Random& random, double probability) {
  return uniform(random, 0, 1) < probability;
}
// Mostly an ordinary value, sometimes an extreme one.
template <typename T>
T field(Random& random, T low, T high) {
  if (chance(random, 0.8)) return integer<T>(random, low, high);
  const T extremes[] = {0, 1, std::numeric_limits<T>::min(), std::numeric_limits<T>::max()};
  return extremes[integer<int>(random, 0, 3)];
}

class Hostile {
 public:
  explicit Hostile(Board& board, Judge& judge) : board_(board), judge_(judge) {}

  void deed(Deed deed, std::uint64_t seed) {
    Random random(seed);
    switch (deed) {
      case Deed::press:
        press(random);
        break;
      case Deed::anything:
        send(anything(random));
        break;
      case Deed::rest:
        rest(random);
        break;
      case Deed::replay:
        replay(random);
        break;
      case Deed::noise:
        noise(random);
        break;
      case Deed::damage:
        damage(random);
        break;
      case Deed::page:
        page(random);
        break;
      case Deed::silence:
        run(random, integer<int>(random, 1, 40));
        break;
      case Deed::stall:
        judge_.step(integer<std::uint64_t>(random, 1000, 40'000));
        break;
      case Deed::jump:
        jump(random);
        break;
      case Deed::burst:
        burst(random);
        break;
      case Deed::sense:
        sense(random);
        break;
      case Deed::weird:
        weird(random);
        break;
    }
    if (chance(random, 0.7)) judge_.step(chance(random, 0.9) ? 1000 : integer<std::uint64_t>(random, 0, 3000));
  }

 private:
  void send(const jnd_command& command) {
    ReportBytes bytes{};
    jnd_encode_command(&command, bytes.data());
    send(bytes);
  }
  void send(const ReportBytes& bytes) {
    if (sent_.size() < 64) sent_.push_back(bytes);
    judge_.give(bytes.data(), bytes.size());
  }
  std::uint32_t next(Random& random) const {
    if (chance(random, 0.95)) return judge_.last() + 1;
    return integer<std::uint32_t>(random, 0, 4294967295U);
  }
  // Fields as hosts might fill them, and as none should.
  jnd_command anything(Random& random) const {
    jnd_command command{};
    command.sequence = next(random);
    command.mode = static_cast<std::uint8_t>(integer<int>(random, chance(random, 0.1) ? 0 : 1, 3));
    command.touching = chance(random, 0.9);
    for (std::int32_t& part : command.contact_point_nm) part = field<std::int32_t>(random, -20'000'000, 20'000'000);
    direction(random, command);
    command.penetration_nm = field<std::uint32_t>(random, 0, 12'000'000);
    command.penetration_rate_um_per_s = field<std::int32_t>(random, -200'000, 200'000);
    command.stiffness_mn_per_m = field<std::uint32_t>(random, 0, 2'500'000);
    command.most_force_un = field<std::uint32_t>(random, 0, 6'000'000);
    command.damping_cn_s_per_m = field<std::uint16_t>(random, 0, 6000);
    command.roll_dmrad = field<std::int16_t>(random, -7000, 7000);
    command.pitch_dmrad = field<std::int16_t>(random, -6000, 6000);
    command.vibration_mg = field<std::uint16_t>(random, 0, 1200);
    command.vibration_dhz = field<std::uint16_t>(random, 300, 3000);
    return command;
  }
  static void direction(Random& random, jnd_command& command) {
    if (chance(random, 0.05)) {
      for (std::int32_t& part : command.normal) part = integer<std::int32_t>(random, INT32_MIN, INT32_MAX);
      return;
    }
    Eigen::Vector3d normal(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -0.2, 2));
    normal.normalize();
    if (chance(random, 0.1)) normal *= uniform(random, 0.998, 1.002);
    for (int i = 0; i < 3; ++i) command.normal[i] = static_cast<std::int32_t>(normal[i] * ((1 << 30) - 1));
  }
  // A while of pressing hard, as a host does it: force beyond every limit, 1 kHz.
  void press(Random& random) {
    jnd_command command = anything(random);
    if (command.mode == JND_MODE_REST) command.mode = JND_MODE_WRENCH;
    command.touching = true;
    command.most_force_un = 4'700'000;
    command.penetration_nm = 8'000'000;
    command.stiffness_mn_per_m = integer<std::uint32_t>(random, 500'000, 2'000'000);
    for (int i = integer<int>(random, 1, 60); i > 0; --i) {
      command.sequence = judge_.last() + 1;
      send(command);
      judge_.step(chance(random, 0.95) ? 1000 : integer<std::uint64_t>(random, 500, 5000));
    }
  }
  void rest(Random& random) {
    jnd_command command = anything(random);
    command.mode = JND_MODE_REST;
    send(command);
  }
  void replay(Random& random) {
    if (sent_.empty()) return;
    for (int i = integer<int>(random, 1, 30); i > 0; --i) {
      const ReportBytes again = sent_[integer<std::size_t>(random, 0, sent_.size() - 1)];
      send(again);
    }
  }
  void noise(Random& random) const {
    std::uint8_t bytes[80];
    for (std::uint8_t& byte : bytes) byte = integer<std::uint8_t>(random, 0, 255);
    if (chance(random, 0.7)) bytes[0] = JND_REPORT_COMMAND;
    bytes[1] = 1;
    judge_.give(bytes, integer<std::size_t>(random, 0, sizeof bytes));
  }
  void damage(Random& random) const {
    ReportBytes bytes{};
    const jnd_command command = anything(random);
    jnd_encode_command(&command, bytes.data());
    for (int i = integer<int>(random, 1, 3); i > 0; --i) {
      std::uint8_t& byte = bytes[integer<std::size_t>(random, 0, bytes.size() - 1)];
      byte = static_cast<std::uint8_t>(byte ^ (1U << integer<unsigned>(random, 0, 7)));
    }
    judge_.give(bytes.data(), bytes.size());
  }
  void page(Random& random) const {
    jnd_request request{};
    request.operation = integer<std::uint8_t>(random, 0, 1);
    request.page = integer<std::uint8_t>(random, 0, 6);
    if (chance(random, 0.5))
      for (std::uint8_t& byte : request.data) byte = integer<std::uint8_t>(random, 0, 255);
    ReportBytes bytes{};
    jnd_encode_request(&request, bytes.data());
    judge_.give(bytes.data(), bytes.size());
  }
  void run(Random& random, int steps) const {
    while (steps-- > 0) judge_.step(chance(random, 0.95) ? 1000 : 0);
  }
  void jump(Random& random) const {
    const std::uint64_t far[] = {0, 1, 19'999, 20'000, 20'001, 3'600'000'000ULL, 1ULL << 40U};
    if (chance(random, 0.8))
      judge_.step(far[integer<int>(random, 0, 6)]);
    else
      board_.now_us -= std::min<std::uint64_t>(board_.now_us, integer<std::uint64_t>(random, 1, 100'000));
  }
  // Many commands within one period: the vibration off and on again, rest and pressing in turns.
  void burst(Random& random) {
    for (int i = integer<int>(random, 2, 30); i > 0; --i) {
      jnd_command command = anything(random);
      command.sequence = judge_.last() + 1;
      command.vibration_mg = chance(random, 0.5) ? 0 : 500;
      if (chance(random, 0.3)) command.mode = JND_MODE_REST;
      send(command);
      if (chance(random, 0.2)) judge_.step(1000);
    }
  }
  void sense(Random& random) const {
    const Rrs3Coordinates xi{.pz_m = uniform(random, -0.0285, -0.0115),
                             .roll_rad = uniform(random, -0.7, 0.7),
                             .pitch_rad = uniform(random, -0.6, 0.6)};
    if (const auto joints = joints_at(board_.model, xi)) board_.sensors = sensors_at(*joints);
    board_.sensors.force_n = static_cast<float>(uniform(random, -1, 6));
    board_.sensors.vibration_g = static_cast<float>(uniform(random, 0, 1));
  }
  void weird(Random& random) const {
    const float strange[] = {NAN, INFINITY, -INFINITY, 3e38F, -3e38F, 1e-40F, 0, 7};
    const auto one_of_them = [&] { return strange[integer<int>(random, 0, 7)]; };
    jnd_sensors& sensors = board_.sensors;
    switch (integer<int>(random, 0, 8)) {
      case 0:
        sensors.joint_rad[integer<int>(random, 0, 2)] = one_of_them();
        break;
      case 1:
        for (float& joint : sensors.joint_rad) joint = static_cast<float>(uniform(random, -3.2, 3.2));
        break;
      case 2:
        sensors.force_n = one_of_them();
        break;
      case 3:
        sensors.vibration_g = one_of_them();
        break;
      case 4:
        sensors.temperature_c = one_of_them();
        break;
      case 5:
        sensors.battery_percent = integer<std::uint8_t>(random, 0, 255);
        break;
      case 6:
        sensors.stop_button = !sensors.stop_button;
        break;
      case 7:
        sensors.ok = !sensors.ok;
        break;
      default:
        board_.room = !board_.room;
        break;
    }
    sensors.buttons = integer<std::uint8_t>(random, 0, 255);
    board_.memory_works = chance(random, 0.8);
  }

  Board& board_;
  Judge& judge_;
  std::vector<ReportBytes> sent_;
};

struct Totals {
  long runs = 0, pressed = 0, buzzed = 0;
  double hardest_n = 0, largest_n_m = 0;
};

void hostile_run(const std::vector<std::pair<int, std::uint64_t>>& deeds, Totals& totals) {
  Board board;
  RC_ASSERT(board.power_up());
  Judge judge(board);
  Hostile hostile(board, judge);
  for (const auto& [deed, seed] : deeds) hostile.deed(static_cast<Deed>(deed), seed);
  ++totals.runs;
  totals.pressed += judge.pressed();
  totals.buzzed += judge.buzzed();
  totals.hardest_n = std::max(totals.hardest_n, judge.hardest_n());
  totals.largest_n_m = std::max(totals.largest_n_m, judge.largest_n_m());
}

}  // namespace

TEST_CASE("firmware: a hostile host gets nothing from the actuators beyond the device's limits") {
  Totals totals;
  REQUIRE(rc::check("hostile hosts", [&totals] {
    const auto deeds = *rc::gen::resize(
        60, rc::gen::container<std::vector<std::pair<int, std::uint64_t>>>(
                rc::gen::pair(rc::gen::inRange(0, kDeeds), rc::gen::resize(100, rc::gen::arbitrary<std::uint64_t>()))));
    hostile_run(deeds, totals);
  }));
  // Hosts that never got anything would prove nothing.
  INFO(totals.runs << " runs: " << totals.pressed << " actuations with torque, " << totals.buzzed
                   << " with vibration, at most " << totals.hardest_n << " N and " << totals.largest_n_m << " N m");
  CHECK(totals.pressed > 10 * totals.runs);
  CHECK(totals.buzzed > totals.runs);
  CHECK(totals.hardest_n > 1);
}

TEST_CASE("firmware: with a steady host the force never rises faster than its limit") {
  REQUIRE(rc::check("rise", [] {
    Random random(*rc::gen::arbitrary<std::uint64_t>());
    Board board;
    RC_ASSERT(board.power_up());
    double before = 0;
    for (std::uint32_t sequence = 1; sequence < 600; ++sequence) {
      jnd_command command = pressing(sequence, uniform(random, 0, 2000), uniform(random, 0, 0.01));
      command.touching = chance(random, 0.9);
      board.give(command);
      const std::uint64_t elapsed_us = integer<std::uint64_t>(random, 200, 3000);
      board.step(elapsed_us);
      const auto at = board.model.configuration({.pz_m = -0.02});
      const double force =
          force_along(*board.model.differential(*at),
                      {board.given.torque_n_m[0], board.given.torque_n_m[1], board.given.torque_n_m[2]}, {0, 0, 1});
      RC_ASSERT(force <= before + 500e-6 * static_cast<double>(elapsed_us) + 1e-4);
      RC_ASSERT(force <= 4.7 * (1 + 1e-4));
      before = force;
    }
  }));
}
