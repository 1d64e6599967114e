// Magnitude estimation against the reference numbers, and at its edges by hand.
#include "analysis/scaling/magnitude.h"

#include <cmath>

#include "analysis/numerics/special_values.h"
#include "analysis/selftest/model_quantities.h"
#include "tests/catch.h"

namespace jnd {
namespace {

TEST_CASE("magnitudes and settings agree with their references in every number", "[analysis][scaling]") {
  int cases = 0;
  for (const SelftestQuantity& quantity : scaling_quantities()) {
    CAPTURE(quantity.name, quantity.largest_difference);
    CHECK(quantity.ok());
    cases += quantity.cases;
  }
  CHECK(cases > 300);
}

TEST_CASE("an exact power law gives its exponent whatever the modulus of the participant", "[analysis][scaling]") {
  MagnitudeEstimates estimates{{100, 400, 900}, {}};
  for (const double modulus : {0.01, 1.0, 250.0})
    estimates.answers.push_back({{modulus * 10}, {modulus * 20, modulus * 20}, {modulus * 30}});
  const MagnitudeScale scale = magnitude_scale(estimates);
  REQUIRE(scale.ok());
  for (const ParticipantMagnitudes& one : scale.participants) {
    CHECK(one.law.exponent == Approx(0.5).epsilon(1e-12));
    CHECK(one.law.se == Approx(0).margin(1e-12));
    CHECK(one.law.r2 == Approx(1).epsilon(1e-12));
    for (std::size_t i = 0; i < 3; ++i)
      CHECK(one.normalised[i] == Approx(scale.group_geometric_means[i]).epsilon(1e-12));
  }
  CHECK(scale.exponents.mean == Approx(0.5).epsilon(1e-12));
  for (const double se : scale.group_ln_se) CHECK(se == Approx(0).margin(1e-12));
  CHECK(scale.grand_geometric_mean == Approx(std::cbrt(0.01 * 250) * std::cbrt(6000)).epsilon(1e-12));
}

TEST_CASE("stimuli weigh the same, whatever their repeats", "[analysis][scaling]") {
  const MagnitudeScale few = magnitude_scale({{1, 10}, {{{2}, {8}}}});
  const MagnitudeScale many = magnitude_scale({{1, 10}, {{{2}, {4, 16, 8, 8, 8}}}});
  CHECK(many.participants[0].geometric_mean == Approx(4).epsilon(1e-14));
  CHECK(many.participants[0].law.exponent == Approx(few.participants[0].law.exponent).epsilon(1e-14));
}

TEST_CASE("answers that are all alike have the exponent 0 and no r2", "[analysis][scaling]") {
  for (const std::vector<std::vector<double>>& answers :
       {std::vector<std::vector<double>>{{7, 7, 7}, {7}, {7, 7}, {7, 7, 7}}, {{4}, {2, 8}, {1, 16}, {0.1, 160}}}) {
    const MagnitudeScale scale = magnitude_scale({{100, 200, 300, 400}, {answers}});
    const PowerLaw& law = scale.participants[0].law;
    CHECK(law.status == StatisticStatus::ok);
    CHECK(law.exponent == 0);
    CHECK((law.se == 0 && law.ci_low == 0 && law.ci_high == 0 && law.residual_sd == 0));
    CHECK(std::isnan(law.r2));
    CHECK(law.r2_status == StatisticStatus::no_variance);
    CHECK(law.interval_status == StatisticStatus::ok);
  }
}

TEST_CASE("two stimuli have a line and no error, one has none", "[analysis][scaling]") {
  const PowerLaw two = power_law({0, 1}, {1, 3});
  CHECK((two.exponent == 2 && two.intercept == 1 && two.r2 == 1));
  CHECK((std::isnan(two.se) && std::isnan(two.ci_low) && std::isnan(two.ci_high) && std::isnan(two.residual_sd)));
  CHECK((two.status == StatisticStatus::ok && two.interval_status == StatisticStatus::too_few));
  const MagnitudeScale one = magnitude_scale({{100}, {{{3, 12}}}});
  CHECK(one.participants[0].cells[0] == Approx(6).epsilon(1e-14));
  CHECK((std::isnan(one.group.exponent) && std::isnan(one.group.intercept) && std::isnan(one.group.r2)));
  CHECK(one.group.status == StatisticStatus::too_few);
  CHECK(std::isnan(one.exponents.mean));
  CHECK(one.group_ln_se.empty());
}

TEST_CASE("one answer of 0 or below refuses the set, and every such place is told", "[analysis][scaling]") {
  const MagnitudeScale scale = magnitude_scale({{1, 2}, {{{1, -0.0}, {3}}, {{1}, {2, 5, -1e-300}}}});
  CHECK_FALSE(scale.ok());
  REQUIRE(scale.refused.size() == 2);
  CHECK((scale.refused[0].participant == 1 && scale.refused[0].stimulus == 1 && scale.refused[0].repeat == 2));
  CHECK((scale.refused[1].participant == 2 && scale.refused[1].stimulus == 2 && scale.refused[1].repeat == 3));
  CHECK(scale.participants.empty());
  CHECK(magnitude_scale({{1, 2}, {{{1e-300}, {1e300}}}}).ok());
}

}  // namespace
}  // namespace jnd
