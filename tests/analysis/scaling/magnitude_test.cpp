// Magnitude estimation and the method of adjustment.
#include "analysis/scaling/magnitude.h"

#include <cmath>

#include "analysis/numerics/special_values.h"
#include "analysis/scaling/adjustment.h"
#include "analysis/selftest/model_quantities.h"
#include "tests/catch.h"

namespace jnd {
namespace {

// Magnitude estimation against the reference numbers, and at its edges by hand.

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

// The method of adjustment at its edges; its reference numbers are those above.

std::vector<Setting> settings_of(const std::vector<double>& above, const std::vector<double>& below,
                                 const std::vector<double>& unknown = {}) {
  std::vector<Setting> settings;
  for (const double value : above) settings.push_back({value, StartSide::above});
  for (const double value : below) settings.push_back({value, StartSide::below});
  for (const double value : unknown) settings.push_back({value, StartSide::unknown});
  return settings;
}

TEST_CASE("start effect and variable error by hand", "[analysis][scaling]") {
  const Adjustment of = adjustment(settings_of({12, 14}, {8, 10}), 10);
  CHECK((of.settings.mean == 11 && of.constant_error == 1 && of.start_effect == 4 && of.start_df == 2));
  CHECK(of.settings.sd == Approx(std::sqrt(20.0 / 3)).epsilon(1e-14));
  CHECK(of.variable_error == Approx(std::sqrt(2.0)).epsilon(1e-14));
  CHECK(of.jnd_within_side == Approx(kProbableError * std::sqrt(2.0)).epsilon(1e-14));
  CHECK(of.start_t == Approx(4 / std::sqrt(2.0)).epsilon(1e-14));
  // Student's t with 2 degrees of freedom in closed form.
  CHECK(of.start_p == Approx(1 - of.start_t / std::sqrt(2 + of.start_t * of.start_t)).epsilon(1e-12));
  CHECK(of.weber == Approx(of.jnd / 10).epsilon(1e-15));
}

// The quantiles of 9 degrees of freedom were checked by integrating the density, that of 1 is the square of a normal one.
TEST_CASE("the JND's interval is that of a standard deviation", "[analysis][scaling]") {
  std::vector<Setting> settings;
  for (int i = 0; i < 10; ++i) settings.push_back({500.0 + 10 * i, StartSide::unknown});
  const Adjustment found = adjustment(settings, 500);
  CHECK(found.jnd_low == Approx(found.jnd * std::sqrt(9 / 19.022767798641)).epsilon(1e-12));
  CHECK(found.jnd_high == Approx(found.jnd * std::sqrt(9 / 2.7003894999803584)).epsilon(1e-12));
  const Adjustment two = adjustment(std::vector<Setting>{{1, StartSide::above}, {2, StartSide::below}}, 1);
  CHECK(two.jnd_high == Approx(two.jnd / std::sqrt(0.0009820691171752583)).epsilon(1e-9));
  CHECK(std::isnan(adjustment(std::vector<Setting>{{1, StartSide::above}}, 1).jnd_low));
}

TEST_CASE("a large offset costs no digits", "[analysis][scaling]") {
  const Adjustment near = adjustment(settings_of({3, 5, 4}, {1, 2, 0}), 2);
  const Adjustment far = adjustment(settings_of({1e9 + 3, 1e9 + 5, 1e9 + 4}, {1e9 + 1, 1e9 + 2, 1e9}), 1e9 + 2);
  CHECK(far.settings.sd == Approx(near.settings.sd).epsilon(1e-14));
  CHECK(far.start_t == Approx(near.start_t).epsilon(1e-14));
  CHECK(far.constant_error == Approx(near.constant_error).epsilon(1e-9));
}

TEST_CASE("what is undefined of settings has a status", "[analysis][scaling]") {
  const Adjustment one = adjustment(settings_of({5}, {}), 4);
  CHECK((one.settings.mean == 5 && one.constant_error == 1));
  CHECK((std::isnan(one.jnd) && std::isnan(one.weber) && std::isnan(one.start_effect)));
  CHECK((one.settings.status == StatisticStatus::too_few && one.start_status == StatisticStatus::not_applicable));
  const Adjustment each = adjustment(settings_of({5}, {3}), 4);
  CHECK((each.start_effect == 2 && each.start_status == StatisticStatus::ok));
  CHECK((std::isnan(each.variable_error) && std::isnan(each.start_t)));
  CHECK(each.start_test_status == StatisticStatus::too_few);
  const Adjustment constant = adjustment(settings_of({5, 5}, {3, 3, 3}), 4);
  CHECK((constant.variable_error == 0 && constant.jnd_within_side == 0 && std::isnan(constant.start_p)));
  CHECK(constant.start_test_status == StatisticStatus::no_variance);
  CHECK(constant.jnd > 0);
  const Adjustment unknown = adjustment(settings_of({5, 6}, {}, {3, 4}), 4);
  CHECK((unknown.settings.n == 4 && unknown.start_status == StatisticStatus::not_applicable));
}

TEST_CASE("a group with a JND of 0 or none has no geometric mean", "[analysis][scaling]") {
  const Adjustment usual = adjustment(settings_of({5, 7}, {3, 4}), 4), zero = adjustment(settings_of({5, 5, 5}, {}), 4);
  const Adjustment single = adjustment(settings_of({5}, {}), 4);
  const AdjustmentGroup with_zero = adjustment_group(std::vector{usual, usual, zero});
  CHECK(with_zero.jnd.mean == Approx(2 * usual.jnd / 3).epsilon(1e-14));
  CHECK((std::isnan(with_zero.jnd_geometric_mean) && with_zero.ln_jnd_status == StatisticStatus::no_variance));
  const AdjustmentGroup with_single = adjustment_group(std::vector{usual, single});
  CHECK((std::isnan(with_single.jnd.mean) && with_single.jnd.status == StatisticStatus::too_few));
  CHECK((std::isnan(with_single.jnd_geometric_mean) && with_single.ln_jnd_status == StatisticStatus::too_few));
  CHECK((with_single.start_effect.n == 1 && with_single.start_effect.mean == usual.start_effect));
  CHECK(with_single.start_effect_test.status == StatisticStatus::too_few);
  const AdjustmentGroup alike = adjustment_group(std::vector{usual, usual});
  CHECK((std::isnan(alike.constant_error_test.t) && alike.constant_error_test.status == StatisticStatus::no_variance));
  const AdjustmentGroup none = adjustment_group(std::vector{zero, zero});
  CHECK((none.start_status == StatisticStatus::not_applicable && std::isnan(none.start_effect.mean)));
}

}  // namespace
}  // namespace jnd
