// What a contact asks of a device, whatever device it is: force, and the amplitude of a burst.
#include "devices/loop/rendering.h"

#include <cmath>

#include "analysis/numerics/special_values.h"
#include "tests/catch.h"

using namespace jnd;

TEST_CASE("rendering laws (37) and (38)") {
  // Reference values: independent numpy model.
  CHECK(contact_force_n(500, 0.003) == Approx(1.5));
  CHECK(contact_force_n(1200, 0.003) == Approx(3.6));
  CHECK(burst_amplitude_g(0) == Approx(0.4));
  CHECK(burst_amplitude_g(500) == Approx(0.733333333333333));
  CHECK(burst_amplitude_g(900) == Approx(1.0));
  for (const double k : {100.0, 500.0, 900.0}) CHECK(stiffness_of_amplitude_n_per_m(burst_amplitude_g(k)) == Approx(k));
}

TEST_CASE("a damped contact resists going in, eases coming out, and never pulls") {
  CHECK(contact_force_n(500, 0.004, 0, 0.1) == contact_force_n(500, 0.004));
  CHECK(contact_force_n(500, 0.004, 2, 0.1) == Approx(2.2));
  CHECK(contact_force_n(500, 0.004, 2, -0.1) == Approx(1.8));
  CHECK(contact_force_n(500, 0.004, 2, -10) == 0);
  CHECK(contact_force_n(500, 0, 2, 10) == 0);  // no contact, no force
  const double nan = kNaN;
  CHECK(std::isnan(contact_force_n(500, nan, 2, 0)));
  CHECK(std::isnan(contact_force_n(500, 0.004, 2, nan)));
  // A closed stroke takes work from the finger: b times the integral of the squared speed.
  double work = 0;
  constexpr int kTicks = 10000;
  for (int i = 0; i < kTicks; ++i) {
    const double t = 2 * M_PI * (i + 0.5) / kTicks;  // period 1 s
    const double depth = 0.005 + 0.002 * std::sin(t), rate = 2 * M_PI * 0.002 * std::cos(t);
    work += contact_force_n(700, depth, 3, rate) * rate / kTicks;
  }
  CHECK(work == Approx(3 * std::pow(2 * M_PI * 0.002, 2) / 2));
}
