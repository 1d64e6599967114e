// What the 3RRS device renders on a finger, pressed through the governor as in a study.
#include "devices/rrs3/rrs3_rendering.h"

#include <cmath>

#include "protocols/input/input_error.h"
#include "tests/catch.h"
#include "tests/devices/device_fixtures.h"

using namespace jnd;
using namespace jnd::testing;

TEST_CASE("wrench mode renders what is asked on a finger of 1000 N/m, within one per cent") {
  for (const double stiffness : {500.0, 600.0, 700.0, 900.0}) {
    const auto answer = measure_rendered_stiffness(rrs3_spec(), {.stiffness_n_per_m = stiffness});
    CHECK(answer.asked_n_per_m == stiffness);
    CHECK(answer.expected_n_per_m == stiffness);
    CHECK(answer.rendered_n_per_m == Approx(stiffness).epsilon(0.01));
    REQUIRE(answer.curve.size() == 10);
    for (std::size_t i = 1; i < answer.curve.size(); ++i) {
      CHECK(answer.curve[i].depth_m > answer.curve[i - 1].depth_m);
      CHECK(answer.curve[i].force_n > answer.curve[i - 1].force_n);
    }
    CHECK(answer.curve.back().force_n < 4.7);
  }
}

TEST_CASE("position control renders the series value, within 0.5 per cent, tilted too") {
  for (const double stiffness : {100.0, 500.0, 600.0, 700.0, 900.0, 2000.0}) {
    for (const double tilt : {0.0, 0.3}) {
      const auto answer = measure_rendered_stiffness(
          rrs3_spec(),
          {.stiffness_n_per_m = stiffness, .mode = RenderingMode::pd, .roll_rad = tilt, .pitch_rad = -tilt});
      CHECK(answer.expected_n_per_m == Approx(stiffness * 1000 / (stiffness + 1000)));
      CHECK(answer.rendered_n_per_m == Approx(answer.expected_n_per_m).epsilon(0.005));
    }
  }
  const auto firm = measure_rendered_stiffness(
      rrs3_spec(), {.stiffness_n_per_m = 500, .mode = RenderingMode::pd, .finger_n_per_m = 10000});
  CHECK(firm.rendered_n_per_m == Approx(476.19).epsilon(0.005));
}

TEST_CASE("the printed law departs from the series value the deeper the more") {
  const auto answer =
      measure_rendered_stiffness(rrs3_spec(), {.stiffness_n_per_m = 500, .mode = RenderingMode::pd_literal});
  CHECK(answer.expected_n_per_m == Approx(333.333).epsilon(1e-5));
  double before = 0;
  for (const DepthAndForce& point : answer.curve) {
    const double error = point.force_n / point.depth_m / answer.expected_n_per_m - 1;
    CHECK(error > before);
    before = error;
  }
  CHECK(before == Approx(0.054).margin(0.005));  // at 5 mm, where the platform hangs 3.2 mm behind
  CHECK(answer.rendered_n_per_m / answer.expected_n_per_m == Approx(1.038).margin(0.005));
}

TEST_CASE("what cannot be pressed is refused") {
  CHECK_THROWS_AS(measure_rendered_stiffness(rrs3_spec(), {.stiffness_n_per_m = 0}), InputError);
  CHECK_THROWS_AS(measure_rendered_stiffness(rrs3_spec(), {.stiffness_n_per_m = std::nan("")}), InputError);
  CHECK_THROWS_AS(measure_rendered_stiffness(rrs3_spec(), {.stiffness_n_per_m = 2001}), InputError);
  CHECK_THROWS_AS(measure_rendered_stiffness(rrs3_spec(), {.stiffness_n_per_m = 500, .finger_n_per_m = 100}),
                  InputError);
  CHECK_THROWS_AS(measure_rendered_stiffness(rrs3_spec(), {.stiffness_n_per_m = 500, .roll_rad = 1}), InputError);
  CHECK_THROWS_AS(measure_rendered_stiffness(rrs3_spec(), {.stiffness_n_per_m = 500, .depths = 0}), InputError);
}
