// The law of force and the device's own limits, against the same law in double precision, and limit by limit.
#include <algorithm>
#include <cmath>

#include <rapidcheck.h>

#include "devices/hid/firmware/jnd_burst.h"
#include "tests/catch.h"
#include "tests/devices/hid/firmware/firmware_fixtures.h"

using namespace jnd;
using namespace jnd::testing;

namespace {

const jnd_limits& shipped() {
  static const jnd_limits limits = jnd_fingertip_default_config("TEST-1", JND_INDEX).limits;
  return limits;
}
jnd_own_limits own_limits() {
  return jnd_own_limits_of(&shipped(), 20);
}

// Long active, and risen before: nothing but the law and the cap acts.
jnd_law_input settled() {
  return {.previous_n = 100, .elapsed_s = 0.001F, .since_us = 10'000'000, .in_workspace = true};
}

// PROTOCOL.md, "The law of force", in double precision.
double law_n(const jnd_command& command, const jnd_law_input& input) {
  if (!command.touching) return 0;
  const double stiffness = std::min(command.stiffness_mn_per_m, shipped().most_stiffness_mn_per_m) * 1e-3;
  const double damping = std::min(command.damping_cn_s_per_m, shipped().most_damping_cn_s_per_m) * 1e-2;
  double force = stiffness * command.penetration_nm * 1e-9 + damping * command.penetration_rate_um_per_s * 1e-6;
  force = std::min({force, command.most_force_un * 1e-6, shipped().most_force_un * 1e-6});
  const double soft = static_cast<double>(input.since_us) / (shipped().soft_start_ms * 1e3);
  force = std::min(force, std::min(1.0, soft) * shipped().most_force_un * 1e-6);
  const Eigen::Vector3d normal = Eigen::Vector3d(command.normal[0], command.normal[1], command.normal[2]) / (1 << 30);
  if (std::abs(normal.norm() - 1) > 1e-3 || normal.z() <= 0 || !input.in_workspace) return 0;
  force = std::min(force, input.previous_n + 1e-3 * shipped().most_force_rise_mn_per_s * input.elapsed_s);
  return std::max(0.0, force);
}

std::uint16_t limits_of(const jnd_command& command, const jnd_law_input& input) {
  const jnd_own_limits own = own_limits();
  std::uint16_t limits = 0;
  jnd_law_force(&own, &command, &input, &limits);
  return limits;
}

}  // namespace

TEST_CASE("firmware: the law is that of the protocol, whatever the fields hold") {
  double worst = 0;
  REQUIRE(rc::check("law", [&] {
    const auto between = [](std::int64_t low, std::int64_t high) {
      return *rc::gen::resize(rc::kNominalSize, rc::gen::inRange<std::int64_t>(low, high + 1));
    };
    jnd_command command = pressing(1);
    command.touching = between(0, 9) > 0;
    command.penetration_nm = static_cast<std::uint32_t>(between(0, between(0, 3) == 0 ? 4294967295 : 12'000'000));
    command.penetration_rate_um_per_s = static_cast<std::int32_t>(between(-2'000'000, 2'000'000));
    command.stiffness_mn_per_m = static_cast<std::uint32_t>(between(0, between(0, 3) == 0 ? 4294967295 : 2'500'000));
    command.most_force_un = static_cast<std::uint32_t>(between(0, 9'000'000));
    command.damping_cn_s_per_m = static_cast<std::uint16_t>(between(0, 65535));
    const Eigen::Vector3d normal =
        Eigen::Vector3d(static_cast<double>(between(-1000, 1000)), static_cast<double>(between(-1000, 1000)),
                        static_cast<double>(between(-300, 1000)))
            .normalized() *
        (between(0, 9) > 0 ? 1.0 : 1.0 + 1e-5 * static_cast<double>(between(-300, 300)));
    RC_PRE(normal.allFinite());
    // At the bounds themselves the two precisions may differ.
    RC_PRE(std::abs(std::abs(normal.norm() - 1) - 1e-3) > 1e-6);
    for (int i = 0; i < 3; ++i) command.normal[i] = static_cast<std::int32_t>(std::lround(normal[i] * ((1 << 30) - 1)));
    jnd_law_input input = settled();
    input.previous_n = static_cast<float>(static_cast<double>(between(0, 4700)) * 1e-3);
    input.elapsed_s = static_cast<float>(static_cast<double>(between(0, 20000)) * 1e-6);
    input.since_us = static_cast<std::uint64_t>(between(0, 400'000));
    input.in_workspace = between(0, 9) > 0;
    const jnd_own_limits own = own_limits();
    std::uint16_t limits = 0;
    const double ours = jnd_law_force(&own, &command, &input, &limits), theirs = law_n(command, input);
    // Where spring and damper cancel, the rounding of each part is left.
    const double parts = 1e-9 * command.penetration_nm * 2000 + 50e-6 * std::abs(command.penetration_rate_um_per_s);
    const double apart = std::abs(ours - theirs) / (theirs + 1e-3 * std::min(parts, 4.7) + 1e-6);
    const double rounding = 4e-7 * parts / (theirs + 1e-3 * std::min(parts, 4.7) + 1e-6);
    worst = std::max(worst, apart - rounding);
    RC_ASSERT(apart <= 1e-5 + rounding);
  }));
  INFO("worst relative difference beyond the parts' rounding " << worst);
  CHECK(worst < 1e-5);
}

TEST_CASE("firmware: each limit acts, and says so") {
  const jnd_own_limits own = own_limits();
  std::uint16_t limits = 0;
  jnd_command command = pressing(1, 600, 0.002);
  jnd_law_input input = settled();
  SECTION("none") {
    CHECK(jnd_law_force(&own, &command, &input, &limits) == Approx(1.2));
    CHECK(limits == 0);
  }
  SECTION("the device's cap") {
    command = pressing(1, 1000, 0.006);
    CHECK(jnd_law_force(&own, &command, &input, &limits) == Approx(4.7));
    CHECK(limits == JND_LIMIT_FORCE);
  }
  SECTION("the host's cap") {
    command.most_force_un = 500'000;
    CHECK(jnd_law_force(&own, &command, &input, &limits) == Approx(0.5));
    CHECK(limits == JND_LIMIT_FORCE);
  }
  SECTION("a host's cap that is the law's own force, rounded, is no limit") {
    command = pressing(1, 617.2839, 0.0019876543);
    command.most_force_un = static_cast<std::uint32_t>(std::lround(617.2839 * 0.0019876543 * 1e6));
    CHECK(jnd_law_force(&own, &command, &input, &limits) == Approx(1.22694).epsilon(1e-5));
    CHECK(limits == 0);
  }
  SECTION("stiffness and damping") {
    command = pressing(1, 2500, 0.001);
    CHECK(jnd_law_force(&own, &command, &input, &limits) == Approx(2.0));
    CHECK(limits == JND_LIMIT_STIFFNESS);
    command = pressing(1, 600, 0.001);
    command.damping_cn_s_per_m = 6000;
    command.penetration_rate_um_per_s = 10'000;
    limits = 0;
    CHECK(jnd_law_force(&own, &command, &input, &limits) == Approx(0.6 + 0.5));
    CHECK(limits == JND_LIMIT_STIFFNESS);
  }
  SECTION("soft start") {
    input.since_us = 20'000;
    CHECK(jnd_law_force(&own, &command, &input, &limits) == Approx(0.47));
    CHECK(limits == JND_LIMIT_SOFT_START);
  }
  SECTION("rise, and no limit on falling") {
    input.previous_n = 0.3F;
    CHECK(jnd_law_force(&own, &command, &input, &limits) == Approx(0.8));
    CHECK(limits == JND_LIMIT_RISE);
    input.previous_n = 4.7F;
    limits = 0;
    CHECK(jnd_law_force(&own, &command, &input, &limits) == Approx(1.2));
    CHECK(limits == 0);
  }
  SECTION("workspace") {
    input.in_workspace = false;
    CHECK(jnd_law_force(&own, &command, &input, &limits) == 0);
    CHECK(limits == JND_LIMIT_WORKSPACE);
  }
  SECTION("damping never pulls") {
    command.damping_cn_s_per_m = 5000;
    command.penetration_rate_um_per_s = -100'000;
    CHECK(jnd_law_force(&own, &command, &input, &limits) == 0);
    CHECK(limits == 0);
  }
  SECTION("without contact") {
    command.touching = false;
    CHECK(jnd_law_force(&own, &command, &input, &limits) == 0);
    CHECK(limits == 0);
  }
}

TEST_CASE("firmware: a normal that is none, or pulls, gives no force") {
  jnd_command command = pressing(1);
  CHECK(limits_of(command, settled()) == 0);
  const auto limits_with = [&](double x, double y, double z) {
    const double one = 1 << 30;
    command.normal[0] = static_cast<std::int32_t>(x * one);
    command.normal[1] = static_cast<std::int32_t>(y * one);
    command.normal[2] = static_cast<std::int32_t>(z * one);
    return limits_of(command, settled());
  };
  CHECK(limits_with(0, 0, 1.0009) == 0);
  CHECK(limits_with(0, 0, 0.9991) == 0);
  CHECK(limits_with(0.6, 0, 0.8) == 0);
  CHECK(limits_with(0, 0, 1.0011) == JND_LIMIT_DIRECTION);
  CHECK(limits_with(0, 0, 0.9989) == JND_LIMIT_DIRECTION);
  CHECK(limits_with(0, 0, -1) == JND_LIMIT_DIRECTION);
  CHECK(limits_with(1, 0, 0) == JND_LIMIT_DIRECTION);
  CHECK(limits_with(0, 0, 0) == JND_LIMIT_DIRECTION);
  CHECK(limits_with(-1.9, 1.9, 1.9) == JND_LIMIT_DIRECTION);
}

TEST_CASE("firmware: tilt is clipped") {
  const jnd_own_limits own = own_limits();
  jnd_command command{};
  std::uint16_t limits = 0;
  float roll = 0, pitch = 0;
  command.roll_dmrad = 6283;
  command.pitch_dmrad = -5236;
  jnd_law_tilt(&own, &command, &roll, &pitch, &limits);
  CHECK(roll == Approx(0.6283));
  CHECK(pitch == Approx(-0.5236));
  CHECK(limits == 0);
  command.roll_dmrad = -32768;
  command.pitch_dmrad = 32767;
  jnd_law_tilt(&own, &command, &roll, &pitch, &limits);
  CHECK(roll == Approx(-0.6283));
  CHECK(pitch == Approx(0.5236));
  CHECK(limits == JND_LIMIT_TILT);
}

TEST_CASE("firmware: vibration stays in the motor's range and ends with its burst") {
  const jnd_own_limits own = own_limits();
  jnd_burst burst{};
  jnd_command command = pressing(1);
  float g = 0, hz = 0;
  std::uint16_t limits = 0;
  const auto at_ms = [&](std::uint64_t ms) {
    limits = 0;
    jnd_burst_step(&burst, &own, &command, ms * 1000, &g, &hz, &limits);
  };
  const auto ask = [&](unsigned mg, unsigned dhz) {
    command.vibration_mg = static_cast<std::uint16_t>(mg);
    command.vibration_dhz = static_cast<std::uint16_t>(dhz);
    jnd_burst_command(&burst, &command);
  };
  ask(500, 1500);
  at_ms(0);
  CHECK(g == Approx(0.5));
  CHECK(hz == Approx(150));
  CHECK(limits == 0);
  ask(10, 3000);
  at_ms(100);
  CHECK(g == Approx(0.05));
  CHECK(hz == Approx(240));
  CHECK(limits == JND_LIMIT_VIBRATION);
  ask(1000, 2400);
  at_ms(249);
  CHECK(g == Approx(1));
  at_ms(250);
  CHECK(g == 0);
  CHECK(hz == 0);
  CHECK(limits == JND_LIMIT_BURST);
  at_ms(5000);
  CHECK(g == 0);
  CHECK(limits == JND_LIMIT_BURST);
  // The 0 comes and goes between two steps: it counts, and is felt for one step.
  ask(0, 0);
  ask(800, 1000);
  at_ms(5001);
  CHECK(g == 0);
  CHECK(limits == 0);
  at_ms(5002);
  CHECK(g == Approx(0.8));
  at_ms(5251);
  CHECK(g == Approx(0.8));
  at_ms(5252);
  CHECK(g == 0);
}
