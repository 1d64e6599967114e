// The functions for long tables against the exact ones.
#include "analysis/lattice/fast_functions.h"

#include <cmath>
#include <vector>

#include "analysis/numerics/normal.h"
#include "tests/catch.h"

namespace jnd {
namespace {

TEST_CASE("the tabled logarithm of the normal distribution is the exact one", "[hierarchical]") {
  for (double z = -45; z < 12; z += 0.00137) {
    const double exact = log_normal_cdf(z).log_cdf, ours = tabled_log_normal_cdf(z);
    if (std::abs(ours - exact) <= 1e-14 + 1e-13 * std::abs(exact)) continue;
    CAPTURE(z, exact, ours);
    CHECK(false);
  }
  CHECK(tabled_log_normal_cdf(-1000) == log_normal_cdf(-1000).log_cdf);
  CHECK(tabled_log_normal_cdf(40) == log_normal_cdf(40).log_cdf);
}

TEST_CASE("exponentials of a row are those of its members, and nothing below e^-700", "[hierarchical]") {
  std::vector<double> values;
  for (double x = -699; x < 1; x += 0.0317) values.push_back(x);
  const std::vector<double> exponents = values;
  exponentiate(values, 0.25);
  for (std::size_t i = 0; i < values.size(); ++i) {
    CAPTURE(exponents[i]);
    REQUIRE(std::abs(values[i] / std::exp(exponents[i] - 0.25) - 1) < 1e-14);
  }
  std::vector<double> tiny = {-701, -1e6, 0};
  exponentiate(tiny, 0);
  CHECK(tiny == std::vector<double>{0, 0, 1});
}

TEST_CASE("logarithms of a row are those of its members", "[hierarchical]") {
  std::vector<double> values = {1, 0.5, 2, 1e-300, 1e300};
  for (double x = -700; x < 5; x += 0.0137) values.push_back(std::exp(x));
  for (double x = 0.7; x < 1.42; x += 1e-4) values.push_back(x);
  const std::vector<double> numbers = values;
  take_logarithms(values);
  for (std::size_t i = 0; i < values.size(); ++i) {
    CAPTURE(numbers[i]);
    const double exact = std::log(numbers[i]);
    REQUIRE(std::abs(values[i] - exact) <= 1e-15 * std::abs(exact));
  }
}

}  // namespace
}  // namespace jnd
