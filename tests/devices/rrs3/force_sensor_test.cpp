// The force sensor: ideal by default; otherwise noise of the asked spread, steps, and a range.
#include <algorithm>
#include <cmath>
#include <vector>

#include <rapidcheck.h>

#include "analysis/numerics/special_values.h"
#include "devices/rrs3/rrs3_device.h"
#include "protocols/input/input_error.h"
#include "tests/catch.h"

using namespace jnd;

TEST_CASE("a sensor without options says what is") {
  ForceSensor sensor;
  for (const double force : {0.0, -1.5, 1e-300, 4.7, 1e6}) CHECK(sensor.measure(force) == force);
  CHECK(std::isnan(sensor.measure(std::nan(""))));
}

TEST_CASE("the noise is Gaussian, of the asked SD, without bias or memory") {
  constexpr int kCount = 100000;
  ForceSensor sensor({.noise_sd_n = 0.02}, 42);
  std::vector<double> noise;
  for (int i = 0; i < kCount; ++i) noise.push_back(sensor.measure(3) - 3);
  double mean = 0, square = 0, fourth = 0, next = 0;
  int within = 0;
  for (int i = 0; i < kCount; ++i) {
    const double z = noise[static_cast<std::size_t>(i)] / 0.02;
    mean += z / kCount;
    square += z * z / kCount;
    fourth += z * z * z * z / kCount;
    within += std::abs(z) < 1;
    if (i > 0) next += z * noise[static_cast<std::size_t>(i) - 1] / 0.02 / kCount;
  }
  // Four standard errors.
  CHECK(std::abs(mean) < 4 / std::sqrt(kCount));
  CHECK(std::abs(square - 1) < 4 * std::sqrt(2.0 / kCount));
  CHECK(std::abs(fourth - 3) < 4 * std::sqrt(96.0 / kCount));
  CHECK(std::abs(next) < 4 / std::sqrt(kCount));
  CHECK(within / static_cast<double>(kCount) == Approx(0.6827).margin(4 * 0.0015));
}

TEST_CASE("the noise depends on seed and part alone") {
  const auto drawn = [](std::uint64_t seed, std::uint64_t part, int before) {
    ForceSensor sensor({.noise_sd_n = 1}, seed);
    for (int i = 0; i < before; ++i) (void)sensor.measure(0);
    sensor.begin(part);
    return std::vector<double>{sensor.measure(0), sensor.measure(0), sensor.measure(0)};
  };
  CHECK(drawn(1, 7, 0) == drawn(1, 7, 5));
  CHECK(drawn(1, 7, 0) != drawn(2, 7, 0));
  CHECK(drawn(1, 7, 0) != drawn(1, 8, 0));
}

TEST_CASE("steps are of the resolution, ends are of the range") {
  REQUIRE(rc::check("steps", [] {
    const double resolution = *rc::gen::element(0.001, 0.01, 0.25);
    ForceSensor sensor({.resolution_n = resolution});
    const double force = *rc::gen::inRange(-100000, 100001) / 12345.0;
    const double said = sensor.measure(force);
    RC_ASSERT(std::abs(said - force) <= resolution / 2 * (1 + 1e-9));
    RC_ASSERT(std::abs(said / resolution - std::round(said / resolution)) < 1e-6);
  }));
  ForceSensor sensor({.noise_sd_n = 0.5, .resolution_n = 0.3, .min_n = 0, .max_n = 5}, 3);
  for (int i = 0; i < 1000; ++i) {
    const double low = sensor.measure(0), high = sensor.measure(5);
    REQUIRE((low >= 0 && low <= 5));
    REQUIRE((high >= 0 && high <= 5));
  }
  CHECK(sensor.measure(1e9) == 5);
  CHECK(sensor.measure(kInf) == 5);
  CHECK(sensor.measure(-7) == 0);
}

TEST_CASE("an impossible sensor is refused") {
  CHECK_THROWS_AS(ForceSensor({.noise_sd_n = -0.1}), InputError);
  CHECK_THROWS_AS(ForceSensor({.noise_sd_n = std::nan("")}), InputError);
  CHECK_THROWS_AS(ForceSensor({.resolution_n = -1}), InputError);
  CHECK_THROWS_AS(ForceSensor({.min_n = 2, .max_n = 2}), InputError);
  CHECK_THROWS_AS(ForceSensor({.max_n = std::nan("")}), InputError);
}
