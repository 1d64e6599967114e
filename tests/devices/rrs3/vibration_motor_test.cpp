// The vibration motor keeps to its range, and its waveform has the asked amplitude and frequency without jumps of
// phase.
#include "devices/rrs3/vibration_motor.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <rapidcheck.h>

#include "protocols/input/input_error.h"
#include "tests/catch.h"

using namespace jnd;

TEST_CASE("amplitude and frequency stay in the motor's range; 0 is off") {
  VibrationMotor motor;
  CHECK(motor.amplitude_g() == 0);
  CHECK(motor.acceleration_m_per_s2() == 0);
  motor.set(2, 300);
  CHECK(motor.amplitude_g() == 1);
  CHECK(motor.frequency_hz() == 240);
  motor.set(0.01, 10);
  CHECK(motor.amplitude_g() == 0.05);
  CHECK(motor.frequency_hz() == 50);
  motor.set(0.5, 200);
  CHECK(motor.amplitude_g() == 0.5);
  CHECK(motor.frequency_hz() == 200);
  for (const double off : {0.0, -1.0, std::nan("")}) {
    motor.set(0.5, 200);
    motor.set(off, 200);
    CHECK(motor.amplitude_g() == 0);
    CHECK(motor.frequency_hz() == 0);
  }
  motor.set(0.5, std::nan(""));
  CHECK(motor.amplitude_g() == 0);
  CHECK_THROWS_AS(VibrationMotor({.min_g = 1, .max_g = 0.5}), InputError);
  CHECK_THROWS_AS(VibrationMotor({.min_hz = -1}), InputError);
  CHECK_THROWS_AS(VibrationMotor({.max_hz = INFINITY}), InputError);
}

TEST_CASE("a sine of the asked amplitude and frequency") {
  VibrationMotor motor;
  motor.set(0.6, 180);
  double square = 0, largest = 0;
  int crossings = 0;
  constexpr int kSteps = 100000;  // one second
  double before = motor.acceleration_m_per_s2();
  CHECK(before == 0);
  for (int i = 1; i <= kSteps; ++i) {
    motor.advance(1.0 / kSteps);
    const double a = motor.acceleration_m_per_s2();
    if (i % 1000 == 0)
      CHECK(a == Approx(0.6 * 9.80665 * std::sin(2 * std::numbers::pi * 180 * i / kSteps)).margin(1e-6));
    square += a * a / kSteps;
    largest = std::max(largest, std::abs(a));
    crossings += before < 0 && a >= 0;
    before = a;
  }
  CHECK(std::sqrt(2 * square) == Approx(0.6 * 9.80665).epsilon(1e-4));
  CHECK(largest == Approx(0.6 * 9.80665).epsilon(1e-4));
  CHECK(std::abs(crossings - 180) <= 1);
}

TEST_CASE("the phase goes on through changes of frequency") {
  REQUIRE(rc::check("continuous", [] {
    VibrationMotor motor;
    constexpr double kStep_s = 1e-5;
    motor.set(0.8, 100);
    double before = motor.acceleration_m_per_s2();
    for (int i = 0; i < 2000; ++i) {
      if (i % 40 == 0) motor.set(0.8, *rc::gen::inRange(50, 241));
      motor.advance(kStep_s);
      const double now = motor.acceleration_m_per_s2();
      // |a'| <= A 2 pi f
      RC_ASSERT(std::abs(now - before) <= 0.8 * 9.80665 * 2 * std::numbers::pi * 240 * kStep_s * (1 + 1e-9));
      before = now;
    }
  }));
}

TEST_CASE("time that is none does not pass") {
  VibrationMotor motor;
  motor.set(0.8, 100);
  motor.advance(0.0012);
  const double a = motor.acceleration_m_per_s2();
  for (const double none : {0.0, -1.0, std::nan(""), HUGE_VAL}) motor.advance(none);
  CHECK(motor.acceleration_m_per_s2() == a);
}
