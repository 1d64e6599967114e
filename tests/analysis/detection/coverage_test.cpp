// How often intervals and tests are right: exact sums, small cases by hand, and the nominal values for many trials.
#include "analysis/detection/coverage.h"

#include <cmath>

#include "analysis/numerics/normal.h"
#include "tests/catch.h"

using namespace jnd;

namespace {

constexpr double kCriteria[] = {-0.5, 0, 0.5};

}  // namespace

TEST_CASE("coverage of one trial a class, by hand", "[analysis]") {
  // The intervals are everything, (-0.60, inf), (-inf, 0.60) and everything: d' = 2 is missed by a miss with a false
  // alarm only, d' = 0 never.
  const ProfileCoverage coverage(1);
  CHECK(coverage.at(0, 0) == Approx(1).epsilon(1e-14));
  CHECK(coverage.at(2, 0) == Approx(1 - normal_cdf(-1) * normal_cdf(-1)).epsilon(1e-13));
  CHECK(coverage.at(-2, 0) == Approx(1 - normal_cdf(-1) * normal_cdf(-1)).epsilon(1e-13));
  CHECK(coverage.at(2, 0.5) == Approx(1 - normal_cdf(-0.5) * normal_cdf(-1.5)).epsilon(1e-13));
}

TEST_CASE("test sizes of one trial a class, by hand", "[analysis]") {
  // A hit without a false alarm has p = 0.096 in the yes-no model and half of it in the differencing model.
  const TestSizes sizes = test_sizes(1, 0);
  CHECK(sizes.yes_no_05 == 0);
  CHECK(sizes.yes_no_01 == 0);
  CHECK(sizes.differencing_05 == Approx(0.25).epsilon(1e-14));
  CHECK(sizes.differencing_01 == 0);
}

TEST_CASE("opposite criteria have the same coverage", "[analysis]") {
  const ProfileCoverage coverage(12);
  for (const double dprime : {0.0, 0.7, 2.0}) {
    CHECK(coverage.at(dprime, 0.5) == Approx(coverage.at(dprime, -0.5)).epsilon(1e-12));
    CHECK(coverage.at(dprime, 0.5) == Approx(coverage.at(-dprime, 0.5)).epsilon(1e-12));
  }
}

TEST_CASE("with 48 trials a class the yes-no profile interval covers d' in 93 to 97 % of experiments", "[analysis]") {
  const ProfileCoverage coverage(48);
  for (const double dprime : {0.0, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0})
    for (const double criterion : kCriteria) {
      CAPTURE(dprime, criterion);
      CHECK(coverage.at(dprime, criterion) > 0.93);
      CHECK(coverage.at(dprime, criterion) < 0.97);
    }
}

TEST_CASE("with 200 trials a class the tests of d' = 0 have their nominal size", "[analysis]") {
  for (const double criterion : kCriteria) {
    CAPTURE(criterion);
    const TestSizes sizes = test_sizes(200, criterion);
    CHECK(std::abs(sizes.yes_no_05 - 0.05) < 0.01);
    CHECK(std::abs(sizes.yes_no_01 - 0.01) < 0.005);
    // Half the outcomes sit at the boundary; the other half makes the full nominal size.
    CHECK(std::abs(sizes.differencing_05 - 0.05) < 0.01);
    CHECK(std::abs(sizes.differencing_01 - 0.01) < 0.005);
  }
}
