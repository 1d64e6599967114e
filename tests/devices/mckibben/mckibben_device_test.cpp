// The McKibben finger behind the device seam: it renders, lets the finger move freely, and lets go when commands stop.
#include "devices/mckibben/mckibben_device.h"

#include <cmath>
#include <functional>
#include <vector>

#include <rapidcheck.h>

#include "analysis/numerics/special_values.h"
#include "devices/loop/governor.h"
#include "tests/catch.h"
#include "tests/devices/mckibben/mckibben_fixtures.h"
#include "tests/units.h"

using namespace jnd;
using namespace jnd::testing;

namespace {

// A finger that moves as a function of time says, in seconds.
class Finger final : public FingerFlexion {
 public:
  explicit Finger(std::function<double(double)> angle) : angle_(std::move(angle)) {}
  double angle_rad(std::int64_t time_ns) const noexcept override { return angle_(1e-9 * static_cast<double>(time_ns)); }

 private:
  std::function<double(double)> angle_;
};

Finger still(double angle) {
  return Finger([angle](double) { return angle; });
}
Finger flexing(double frequency_hz) {
  return Finger([frequency_hz](double t) {
    return straight_rad() +
           (flexed_rad() - straight_rad()) * (1 - std::cos(2 * std::numbers::pi * frequency_hz * t)) / 2;
  });
}

DeviceCommand force(double newton) {
  DeviceCommand command;
  command.force_n = newton;
  return command;
}

// Commands a force every millisecond, and returns the last reading.
DeviceReading hold(MckibbenDevice& device, double newton, std::int64_t& now, int milliseconds) {
  DeviceReading reading;
  for (int i = 0; i < milliseconds; ++i) {
    REQUIRE(device.write(force(newton), now) == DeviceStatus::ok);
    now += kMs;
    REQUIRE(device.read(now, reading) == DeviceStatus::ok);
  }
  return reading;
}

// Delivered over asked stiffness during two cycles of flexion, fitted through the origin.
double rendered_share(const ForceGains& gains, double stiffness, double frequency_hz) {
  const Finger finger = flexing(frequency_hz);
  MckibbenOptions options;
  options.gains = gains;
  options.encoder.pulses_per_turn = 0;
  MckibbenDevice device(options, finger);
  std::int64_t now = 0;
  (void)device.engage(now);
  double products = 0, squares = 0;
  DeviceReading reading;
  const auto milliseconds = static_cast<int>(2000 / frequency_hz);
  (void)device.read(now, reading);
  for (int i = 0; i < milliseconds; ++i) {
    const double flexion = reading.travel - straight_rad();
    products += reading.force_n * flexion;
    squares += flexion * flexion;
    (void)device.write(force(stiffness * flexion), now);
    now += kMs;
    (void)device.read(now, reading);
  }
  return products / squares / stiffness;
}

}  // namespace

TEST_CASE("engaged, it is settled at zero force wherever the finger is") {
  for (const double angle : {straight_rad(), 0.5, 0.7, flexed_rad()}) {
    const Finger finger = still(angle);
    MckibbenDevice device(MckibbenOptions{}, finger);
    std::int64_t now = 5 * kMs;
    REQUIRE(device.engage(now) == DeviceStatus::ok);
    DeviceReading reading;
    REQUIRE(device.read(now, reading) == DeviceStatus::ok);
    CHECK(reading.force_n == Approx(0).margin(1e-9));
    CHECK(reading.time_ns == now);
    CHECK(std::abs(hold(device, 0, now, 100).force_n) < 1e-6);
    CHECK(device.true_angle_rad() == Approx(angle));
    CHECK(device.volts() > 0.1);  // the muscle holds the spring
  }
}

TEST_CASE("a commanded force is reached and held") {
  for (const double angle : {straight_rad(), 0.6, flexed_rad()}) {
    const Finger finger = still(angle);
    MckibbenDevice device(MckibbenOptions{}, finger);
    std::int64_t now = 0;
    (void)device.engage(now);
    for (const double newton : {1.0, 5.0, 15.0, 30.0, 2.0})
      CHECK(hold(device, newton, now, 500).force_n == Approx(newton).epsilon(0.005));
  }
}

TEST_CASE("without a commanded force the finger moves freely") {
  const Finger finger = flexing(0.5);
  MckibbenDevice device(MckibbenOptions{}, finger);
  std::int64_t now = 0;
  (void)device.engage(now);
  double largest = 0;
  for (int i = 0; i < 4000; ++i) largest = std::max(largest, std::abs(hold(device, 0, now, 1).force_n));
  CHECK(largest < 0.6);
}

TEST_CASE("under PI the delivered stiffness is the asked one, under P it is compressed") {
  const ForceGains p{.kp = 0.28}, pi = MckibbenOptions{}.gains;
  for (const double stiffness : {8.0, 25.0, 50.0}) {
    CHECK(rendered_share(pi, stiffness, 0.05) == Approx(1).margin(0.005));
    CHECK(rendered_share(pi, stiffness, 0.5) == Approx(1).margin(0.02));
    CHECK(rendered_share(p, stiffness, 0.05) < 0.85);
  }
}

TEST_CASE("the shipped gains have a margin of two at every angle, for small and large steps") {
  for (const double angle : {straight_rad(), 0.45, 0.6, 0.75, flexed_rad()}) {
    for (const double change : {0.1, 1.0, 28.0}) {
      ForceGains gains = MckibbenOptions{}.gains;
      gains.kp *= 2;
      gains.ki *= 2;
      const MckibbenModel model = mckibben_model(gains, Tendon::unilateral);
      const MckibbenPose pose = *model.pose(angle);
      MckibbenState state = model.steady_state(pose, 1);
      for (int i = 0; i < 10'000; ++i) model.regulate(state, pose, 1 + change);
      double least = 1e9, most = -1e9;
      for (int i = 0; i < 2'000; ++i) {
        model.regulate(state, pose, 1 + change);
        least = std::min(least, model.force_n(pose, state.muscle_pa));
        most = std::max(most, model.force_n(pose, state.muscle_pa));
      }
      CHECK(most - least < 0.01 * change);
    }
  }
}

TEST_CASE("when commands stop, the device vents by itself") {
  const Finger finger = still(0.7);
  MckibbenDevice device(MckibbenOptions{}, finger);
  std::int64_t now = 0;
  (void)device.engage(now);
  CHECK(hold(device, 20, now, 500).force_n == Approx(20).epsilon(0.01));
  const double held = device.gauge_pa();
  DeviceReading reading;
  (void)device.read(now + kMaxAge_ns - 2 * kMs, reading);
  CHECK(reading.force_n == Approx(20).epsilon(0.01));
  CHECK(device.volts() > 0);
  (void)device.read(now + kMaxAge_ns + 2 * kMs, reading);
  CHECK(device.volts() == 0);
  (void)device.read(now + kMaxAge_ns + 120 * kMs, reading);
  CHECK(reading.force_n < 2);
  (void)device.read(now + 900 * kMs, reading);
  CHECK(device.gauge_pa() < 0.001 * held);
  CHECK(reading.force_n == Approx(device.model().pose(0.7)->weight_n));
  // Commands again: it goes on.
  now += 900 * kMs;
  CHECK(hold(device, 5, now, 600).force_n == Approx(5).epsilon(0.01));
}

TEST_CASE("a long silence is the same as one that was watched") {
  const Finger finger = flexing(0.2);
  DeviceReading watched, skipped;
  for (const bool is_watched : {true, false}) {
    MckibbenDevice device(MckibbenOptions{}, finger);
    std::int64_t now = 0;
    (void)device.engage(now);
    (void)hold(device, 20, now, 300);
    if (is_watched)
      for (int i = 0; i < 3000; ++i) (void)device.read(now + i * kMs, watched);
    (void)device.read(now + 3000 * kMs, is_watched ? watched : skipped);
  }
  CHECK(skipped.force_n == Approx(watched.force_n).margin(1e-6));
  CHECK(skipped.travel == watched.travel);
}

TEST_CASE("neutral closes the valve at once, at any time, until the next engage") {
  const Finger finger = still(0.6);
  MckibbenDevice device(MckibbenOptions{}, finger);
  device.neutral();
  std::int64_t now = 0;
  DeviceReading reading;
  CHECK(device.read(now, reading) == DeviceStatus::ok);
  (void)device.engage(now);
  (void)hold(device, 10, now, 300);
  CHECK(device.volts() > 0);
  device.neutral();
  CHECK(device.volts() == 0);
  // Commands that are still under way do not wake it.
  const DeviceReading after = hold(device, 10, now, 1000);
  CHECK(device.volts() == 0);
  CHECK(device.gauge_pa() < 100);
  CHECK(after.force_n <= 0);
  CHECK(device.engage(now) == DeviceStatus::ok);
  CHECK(hold(device, 10, now, 500).force_n == Approx(10).epsilon(0.01));
}

TEST_CASE("travel is the encoder's, within the range") {
  const Finger finger = flexing(0.5);
  MckibbenDevice device(MckibbenOptions{}, finger);
  const double pulse = 2 * std::numbers::pi / 1024;
  std::int64_t now = 0;
  (void)device.engage(now);
  for (int i = 0; i < 2000; ++i) {
    const DeviceReading reading = hold(device, 0, now, 1);
    REQUIRE(reading.travel >= straight_rad());
    REQUIRE(reading.travel <= flexed_rad());
    REQUIRE(std::abs(reading.travel - device.true_angle_rad()) <= pulse / 2 * (1 + 1e-9));
    REQUIRE(std::abs(device.true_angle_rad() - finger.angle_rad(now)) < 1e-6);
    REQUIRE(reading.travel == device.joint_angle_rad());
  }
}

TEST_CASE("a finger beyond the stops stays at them; one that is nowhere is lost, and gets no force") {
  const Finger beyond = still(2.0);
  MckibbenDevice stopped(MckibbenOptions{}, beyond);
  std::int64_t now = 0;
  CHECK(stopped.engage(now) == DeviceStatus::ok);
  CHECK(hold(stopped, 3, now, 500).force_n == Approx(3).epsilon(0.01));
  CHECK(stopped.true_angle_rad() == Approx(flexed_rad()));

  const Finger vanishing([](double t) { return t < 0.3 ? 0.6 : kNaN; });
  MckibbenDevice device(MckibbenOptions{}, vanishing);
  now = 0;
  CHECK(device.engage(now) == DeviceStatus::ok);
  (void)hold(device, 10, now, 290);
  DeviceReading reading;
  CHECK(device.read(320 * kMs, reading) == DeviceStatus::lost);
  CHECK(device.volts() == 0);
  CHECK(device.write(force(10), 320 * kMs) == DeviceStatus::lost);
  CHECK(device.read(1200 * kMs, reading) == DeviceStatus::lost);
  CHECK(std::isfinite(reading.force_n));
  CHECK(reading.force_n <= 0);
  CHECK(device.engage(1200 * kMs) == DeviceStatus::lost);
}

TEST_CASE("no command makes a force that is not a number") {
  REQUIRE(rc::check("commands", [] {
    const Finger finger = flexing(1);
    MckibbenOptions options;
    options.force_sensor = {.noise_sd_n = 0.05, .resolution_n = 0.01, .seed = 3};
    MckibbenDevice device(options, finger);
    std::int64_t now = 0;
    (void)device.engage(now);
    for (int i = 0; i < 100; ++i) {
      const double asked = *rc::gen::element(0.0, 5.0, 30.0, 1e9, -4.0, kNaN, kInf);
      (void)device.write(force(asked), now);
      now += *rc::gen::inRange<std::int64_t>(0, 3 * kMs);
      DeviceReading reading;
      RC_ASSERT(device.read(now, reading) == DeviceStatus::ok);
      RC_ASSERT(std::isfinite(reading.force_n));
      RC_ASSERT(std::abs(reading.force_n) <= 89);
      RC_ASSERT(device.volts() >= 0 && device.volts() <= 10);
    }
  }));
}

TEST_CASE("the controller acts on the sensor's reading, whose noise depends on time and seed alone") {
  const Finger finger = still(0.6);
  MckibbenOptions options;
  options.force_sensor = {.noise_sd_n = 0.1, .resolution_n = 0, .seed = 11};
  std::vector<double> readings[2];
  for (std::vector<double>& series : readings) {
    MckibbenDevice device(options, finger);
    std::int64_t now = 0;
    (void)device.engage(now);
    double moved = 0;
    for (int i = 0; i < 300; ++i) {
      series.push_back(hold(device, 5, now, 1).force_n);
      if (i > 250) moved = std::max(moved, std::abs(device.true_force_n() - 5));
    }
    CHECK(moved > 1e-4);  // the noise goes around the loop
    CHECK(moved < 0.3);
  }
  CHECK(readings[0] == readings[1]);
}
