// SI units and the integers of the reports.
#include <cmath>

#include <rapidcheck.h>

#include "analysis/numerics/special_values.h"
#include "devices/hid/report_words.h"
#include "tests/catch.h"

using namespace jnd;

namespace {

double within(double lowest, double highest) {
  return lowest + (highest - lowest) * static_cast<double>(*rc::gen::inRange(0, 1'000'001)) * 1e-6;
}

}  // namespace

TEST_CASE("a field holds the nearest number, and its largest for what is beyond", "[report_units]") {
  bool number = true;
  CHECK(to_field<std::uint16_t>(1.2344, 0.001, number) == 1234);
  CHECK(to_field<std::uint16_t>(1.2346, 0.001, number) == 1235);
  CHECK(to_field<std::int16_t>(-0.00125, 0.0001, number) == -13);
  CHECK(to_field<std::uint16_t>(-3, 0.001, number) == 0);
  CHECK(to_field<std::uint16_t>(1e9, 0.001, number) == 65535);
  CHECK(to_field<std::int16_t>(-1e9, 0.001, number) == -32768);
  CHECK(to_field<std::int32_t>(kInf, 1e-6, number) == 2147483647);
  CHECK(to_field<std::int32_t>(2147483647.4e-6, 1e-6, number) == 2147483647);
  CHECK(to_field<std::uint32_t>(4294967295e-9, 1e-9, number) == 4294967295U);
  CHECK(number);
  CHECK(to_field<std::int32_t>(std::nan(""), 1e-6, number) == 0);
  CHECK_FALSE(number);
}

TEST_CASE("a command's fields are within half a step of what was asked", "[report_units]") {
  const bool held = rc::check([] {
    DeviceCommand asked;
    asked.force_n = within(0, 10);
    asked.stiffness_n_per_m = within(0.001, 4000);
    asked.penetration_m = within(1e-6, 0.02);
    asked.penetration_rate_m_per_s = within(-0.5, 0.5);
    asked.damping_n_s_per_m = within(0, 50);
    asked.normal = Eigen::Vector3d(within(-0.5, 0.5), within(-0.5, 0.5), 1).normalized();
    asked.roll_rad = within(-0.6, 0.6);
    asked.pitch_rad = within(-0.5, 0.5);
    asked.vibration_g = within(0, 1);
    asked.vibration_hz = within(50, 240);
    asked.contact_point_m = Eigen::Vector3d(within(-0.01, 0.01), within(-0.01, 0.01), within(-0.01, 0.01));
    jnd_command out{};
    RC_ASSERT(to_report(asked, RenderingMode::pd, out));
    RC_ASSERT(out.touching);
    RC_ASSERT(out.mode == JND_MODE_PD);
    const auto near = [](double value, double step, double field) {
      return std::abs(value / step - field) <= 0.5 + 1e-6;
    };
    RC_ASSERT(near(asked.force_n, 1e-6, out.most_force_un));
    RC_ASSERT(near(asked.stiffness_n_per_m, 1e-3, out.stiffness_mn_per_m));
    RC_ASSERT(near(asked.penetration_m, 1e-9, out.penetration_nm));
    RC_ASSERT(near(asked.penetration_rate_m_per_s, 1e-6, out.penetration_rate_um_per_s));
    RC_ASSERT(near(asked.damping_n_s_per_m, 0.01, out.damping_cn_s_per_m));
    RC_ASSERT(near(asked.roll_rad, 1e-4, out.roll_dmrad));
    RC_ASSERT(near(asked.pitch_rad, 1e-4, out.pitch_dmrad));
    RC_ASSERT(near(asked.vibration_g, 1e-3, out.vibration_mg));
    RC_ASSERT(near(asked.vibration_hz, 0.1, out.vibration_dhz));
    for (int i = 0; i < 3; ++i) {
      RC_ASSERT(near(asked.normal[i], std::pow(2.0, -30), out.normal[i]));
      RC_ASSERT(near(asked.contact_point_m[i], 1e-9, out.contact_point_nm[i]));
    }
  });
  CHECK(held);
}

TEST_CASE("a number that is none becomes mode rest", "[report_units]") {
  const auto refused = [](auto spoil) {
    DeviceCommand asked;
    asked.force_n = 1;
    asked.stiffness_n_per_m = 500;
    asked.penetration_m = 0.002;
    spoil(asked);
    jnd_command out{};
    out.mode = JND_MODE_WRENCH;
    out.most_force_un = 7;
    const bool taken = to_report(asked, RenderingMode::wrench, out);
    return !taken && out.mode == JND_MODE_REST && out.most_force_un == 0 && !out.touching;
  };
  const double none = std::nan(""), infinite = kInf;
  CHECK(refused([&](DeviceCommand& command) { command.force_n = none; }));
  CHECK(refused([&](DeviceCommand& command) { command.force_n = infinite; }));
  CHECK(refused([&](DeviceCommand& command) { command.normal.y() = none; }));
  CHECK(refused([&](DeviceCommand& command) { command.vibration_hz = none; }));
  CHECK(refused([&](DeviceCommand& command) { command.penetration_rate_m_per_s = -infinite; }));
  CHECK(refused([&](DeviceCommand& command) { command.contact_point_m.x() = none; }));
  CHECK_FALSE(refused([](DeviceCommand&) {}));
}

TEST_CASE("without contact nothing is touched; a force without one becomes one that gives it", "[report_units]") {
  jnd_command out{};
  REQUIRE(to_report({}, RenderingMode::wrench, out));
  CHECK_FALSE(out.touching);
  CHECK(out.most_force_un == 0);
  CHECK(out.normal[2] == 0);

  DeviceCommand plain;
  plain.force_n = 1.5;
  REQUIRE(to_report(plain, RenderingMode::wrench, out));
  CHECK(out.touching);
  CHECK(out.most_force_un == 1'500'000);
  CHECK(1e-3 * out.stiffness_mn_per_m * 1e-9 * out.penetration_nm == Approx(1.5));
  CHECK(out.normal[2] == JND_NORMAL_ONE);
}

TEST_CASE("telemetry becomes a reading in SI units", "[report_units]") {
  jnd_telemetry telemetry{};
  telemetry.force_un = 1'234'567;
  telemetry.height_nm = -20'000'001;
  telemetry.roll_dmrad = -1234;
  telemetry.pitch_dmrad = 2000;
  telemetry.yaw_dmrad = 100;
  telemetry.vibration_mg = 500;
  const DeviceReading reading = to_reading(telemetry, 42);
  CHECK(reading.time_ns == 42);
  CHECK(reading.force_n == Approx(1.234567).epsilon(1e-12));
  CHECK(reading.travel == Approx(-0.020000001).epsilon(1e-12));
  CHECK(reading.platform.pz_m == reading.travel);
  CHECK(reading.platform.roll_rad == Approx(-0.1234));
  CHECK(reading.platform.pitch_rad == Approx(0.2));
  CHECK(reading.platform.sin_yaw == Approx(std::sin(0.01)));
  CHECK(reading.platform.cos_yaw == Approx(std::cos(0.01)));
  CHECK(reading.vibration_g == Approx(0.5));
}
