// The vibration motor keeps to its range.
#include "devices/rrs3/vibration_motor.h"

#include <cmath>

#include "protocols/input/input_error.h"
#include "tests/catch.h"

using namespace jnd;

TEST_CASE("amplitude and frequency stay in the motor's range; 0 is off") {
  VibrationMotor motor;
  CHECK(motor.amplitude_g() == 0);
  motor.set(2, 300);
  CHECK(motor.amplitude_g() == 1);
  motor.set(0.01, 10);
  CHECK(motor.amplitude_g() == 0.05);
  motor.set(0.5, 200);
  CHECK(motor.amplitude_g() == 0.5);
  for (const double off : {0.0, -1.0, std::nan("")}) {
    motor.set(0.5, 200);
    motor.set(off, 200);
    CHECK(motor.amplitude_g() == 0);
  }
  motor.set(0.5, std::nan(""));
  CHECK(motor.amplitude_g() == 0);
  CHECK_THROWS_AS(VibrationMotor({.min_g = 1, .max_g = 0.5}), InputError);
  CHECK_THROWS_AS(VibrationMotor({.min_hz = -1}), InputError);
  CHECK_THROWS_AS(VibrationMotor({.max_hz = INFINITY}), InputError);
}
