// SI units, numbered streams and what is said of the bus: the small parts of reports.
#include <atomic>
#include <cmath>
#include <fstream>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <rapidcheck.h>

#include "analysis/numerics/special_values.h"
#include "devices/device_error.h"
#include "devices/hid/hidapi_bus.h"
#include "devices/hid/report_counter.h"
#include "devices/hid/report_words.h"
#include "devices/hid/udev_rule.h"
#include "tests/catch.h"

using namespace jnd;
using jnd::ReportCounter;

// SI units and the integers of the reports.

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

// What is missing of a numbered stream.

TEST_CASE("every gap is counted exactly, also where the numbers wrap around", "[report_counter]") {
  const bool held = rc::check([] {
    const auto first = static_cast<std::uint32_t>(-*rc::gen::inRange<std::int64_t>(0, 400));
    const auto lengths = *rc::gen::nonEmpty(rc::gen::container<std::vector<std::uint32_t>>(rc::gen::inRange(1U, 9U)));
    ReportCounter counter;
    std::uint32_t number = first;
    std::int64_t gaps = 0, taken = 0;
    RC_ASSERT(counter.take(number));
    ++taken;
    for (const std::uint32_t length : lengths) {
      number += length;
      gaps += length - 1;
      RC_ASSERT(counter.take(number));
      ++taken;
      RC_ASSERT(static_cast<std::int64_t>(static_cast<std::uint32_t>(number - first)) + 1 == taken + gaps);
    }
    RC_ASSERT(counter.missing() == gaps);
    RC_ASSERT(counter.taken() == taken);
    RC_ASSERT(counter.old() == 0);
  });
  CHECK(held);
}

TEST_CASE("what comes twice or out of order is never shown", "[report_counter]") {
  ReportCounter counter;
  CHECK(counter.take(5));
  CHECK_FALSE(counter.take(5));
  CHECK(counter.take(8));
  CHECK_FALSE(counter.take(7));
  CHECK_FALSE(counter.take(6));
  CHECK(counter.take(9));
  CHECK(counter.taken() == 3);
  CHECK(counter.missing() == 2);
  CHECK(counter.old() == 3);
}

TEST_CASE("a new connection has a numbering of its own", "[report_counter]") {
  ReportCounter counter;
  CHECK(counter.take(1000));
  counter.begin();
  CHECK(counter.take(3));
  CHECK(counter.take(5));
  CHECK(counter.missing() == 1);
  CHECK(counter.taken() == 3);
}

TEST_CASE("a device that began anew on the spot is believed after a while", "[report_counter]") {
  ReportCounter counter;
  CHECK(counter.take(100'000));
  std::uint32_t number = 1;
  while (!counter.take(number)) REQUIRE(++number <= 1000);
  CHECK(number == ReportCounter::kBeginsAnew);
  CHECK(counter.take(number + 1));
  CHECK(counter.missing() == 0);
  CHECK(counter.old() == ReportCounter::kBeginsAnew - 1);
}

// What can be said of hidapi without a device: tests/kernel has the rest.

TEST_CASE("a path that is not there is an error that names it", "[hidapi_bus]") {
  HidapiBus bus;
  // Many times: what hidapi does with a file that is no HID device may go well by chance.
  for (int round = 0; round < 20; ++round)
    for (const char* path : {"/dev/no-such-hidraw", "/dev/null", ""}) {
      CAPTURE(path);
      try {
        (void)bus.open(path);
        FAIL("it was opened");
      } catch (const DeviceError& error) {
        CHECK(std::string(error.what()).find(path) != std::string::npos);
      }
    }
}

TEST_CASE("many threads may list and open at once", "[hidapi_bus]") {
  std::vector<std::thread> threads;
  std::atomic<int> refused{0};
  for (int i = 0; i < 4; ++i)
    threads.emplace_back([&refused] {
      HidapiBus bus;
      for (int round = 0; round < 20; ++round) {
        (void)bus.list();
        try {
          (void)bus.open("/dev/no-such-hidraw");
        } catch (const DeviceError&) {
          ++refused;
        }
      }
    });
  for (std::thread& thread : threads) thread.join();
  CHECK(refused.load() == 80);
}

// The udev rule that is shipped, printed and explained is one and the same; and what doctor says of trackers.

TEST_CASE("a rule names bus, vendor and product in capital digits") {
  CHECK(udev_rule(0x1209, 0x5afe) ==
        "KERNEL==\"hidraw*\", SUBSYSTEM==\"hidraw\", KERNELS==\"0003:1209:5AFE.*\", MODE=\"0660\", "
        "GROUP=\"plugdev\", TAG+=\"uaccess\"");
  CHECK(udev_rule(0x46d, 0xb, 5).find("\"0005:046D:000B.*\"") != std::string::npos);
}

TEST_CASE("the shipped file holds the rules of the virtual devices and nothing else") {
  const std::string name = std::string(kUdevRulesPath).substr(std::string(kUdevRulesPath).rfind('/') + 1);
  CHECK(name < "73-seat-late.rules");  // which acts on uaccess
  std::ifstream file(std::string(JND_SOURCE_DIR) + "/devices/hid/" + name);
  REQUIRE(file);
  std::set<std::string> rules;
  for (std::string line; std::getline(file, line);)
    if (!line.empty() && line[0] != '#') rules.insert(line);
  CHECK(rules == std::set<std::string>{udev_rule(0x1209, 0x5AFE), udev_rule(0x1209, 0x5AFF)});
}
