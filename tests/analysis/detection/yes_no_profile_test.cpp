// Standard error, interval and test of the yes-no d' against R 4.2.2 (signal_detection_reference.json) and 40-digit
// arithmetic (mpmath 1.x), and what must hold for any counts.
#include <rapidcheck.h>

#include "analysis/detection/binomial_likelihood.h"
#include "analysis/detection/dprime_intervals.h"
#include "analysis/numerics/normal.h"
#include "analysis/numerics/profile_interval.h"
#include "tests/analysis/detection/detection_fixtures.h"

using namespace jnd;
using namespace jnd::testing;

TEST_CASE("yes-no numbers of every correction agree with R", "[analysis]") {
  with_each_reference([](const Counts& counts, const nlohmann::json& one) {
    for (const auto& [correction, name] : {std::pair{Correction::none, "yesno_none"},
                                           {Correction::loglinear, "yesno_loglinear"},
                                           {Correction::half, "yesno_half_n"}}) {
      CAPTURE(name);
      const YesNo found = yes_no(counts, correction);
      const nlohmann::json& expected = one.at(name);
      CHECK(agrees(found.hit_rate, expected.at("H"), 1e-10));
      CHECK(agrees(found.false_alarm_rate, expected.at("F"), 1e-10));
      CHECK(agrees(found.z_hit, expected.at("zH"), 1e-10));
      CHECK(agrees(found.z_false_alarm, expected.at("zF"), 1e-10));
      CHECK(agrees(found.dprime, expected.at("dprime"), 1e-10));
      CHECK(agrees(found.criterion, expected.at("criterion_c"), 1e-10));
      CHECK(agrees(found.ln_beta, expected.at("ln_beta"), 1e-10));
      CHECK(agrees(found.se, expected.at("se_gg"), 1e-10));
      CHECK(agrees(found.ci_low, expected.at("wald_lo"), 1e-10));
      CHECK(agrees(found.ci_high, expected.at("wald_hi"), 1e-10));
      CHECK(agrees(normal_cdf(0.5 * found.dprime), expected.at("pc_max_unit_slope"), 1e-10));
    }
  });
}

TEST_CASE("the yes-no profile agrees with R, where rates are 0 or 1 too", "[analysis]") {
  with_each_reference([](const Counts& counts, const nlohmann::json& one) {
    const DprimeProfile found = yes_no_profile(counts);
    const nlohmann::json& expected = one.at("yesno_profile95");
    CHECK((found.status == RateStatus::no_information) == expected.at("no_information").get<bool>());
    CHECK(agrees(found.dprime, expected.at("dprime_mle"), 1e-10));
    CHECK(agrees(found.ci_low, expected.at("lo"), 1e-6));
    CHECK(agrees(found.ci_high, expected.at("hi"), 1e-6));
    CHECK(agrees(found.log_likelihood, expected.at("logLik"), 1e-10));
  });
}

TEST_CASE("a profile of one answer, and of one class", "[analysis]") {
  for (const Counts& counts : {Counts{6, 0, 6, 0}, Counts{1, 1, 3, 3}}) {
    const DprimeProfile found = yes_no_profile(counts);
    CHECK(found.status == RateStatus::no_information);
    CHECK(std::isnan(found.dprime));
    CHECK(found.ci_low == -kInf);
    CHECK(found.ci_high == kInf);
    CHECK(found.log_likelihood == 0);
    CHECK(found.p_value == 1);
  }
  for (const Counts& counts : {Counts{12, 7, 0, 0}, Counts{0, 0, 12, 3}, Counts{}}) {
    const DprimeProfile found = yes_no_profile(counts);
    CHECK(found.status == RateStatus::missing);
    for (const double value : {found.dprime, found.ci_low, found.ci_high, found.log_likelihood, found.p_value,
                               yes_no(counts, Correction::loglinear).se, yes_no(counts, Correction::none).ln_beta})
      CHECK(std::isnan(value));
  }
}

TEST_CASE("one trial a class has the interval of its own likelihood", "[analysis]") {
  // 1/1 hits, 0/1 false alarms: the likelihood Phi(d'/2)^2 falls to exp(-1.92) where Phi(d'/2) = exp(-0.96).
  const DprimeProfile found = yes_no_profile({1, 1, 1, 0});
  CHECK(found.ci_low == Approx(2 * normal_quantile(std::exp(-0.5 * kProfileDrop))).epsilon(1e-11));
  CHECK(found.ci_high == kInf);
  CHECK(found.p_value == Approx(std::erfc(std::sqrt(2 * std::log(2.0)))).epsilon(1e-13));
}

TEST_CASE("a million trials lose no digits", "[analysis]") {
  // mpmath, 40 digits.
  struct Case {
    Counts counts;
    double low, high;
  };
  for (const Case& one : {Case{{1000000, 999999, 1000000, 1}, 9.0405686503453705, 10.207987654478966},
                          Case{{1000000, 999999, 1000000, 999998}, -0.33556459590712843, 0.73949159457234399},
                          Case{{1000000, 1000000, 3, 1}, 4.0960107638487552, kInf}}) {
    const DprimeProfile found = yes_no_profile(one.counts);
    CHECK(agrees(found.ci_low, one.low, 1e-11));
    CHECK(agrees(found.ci_high, one.high, 1e-11));
  }
  CHECK(yes_no_p_value({1000000, 500001, 1000000, 500000}) == Approx(0.99887162120903011).epsilon(1e-14));
  CHECK(yes_no_p_value({1000000000, 500000000, 999999999, 499999999}) == Approx(0.99998215875882658).epsilon(1e-14));
  CHECK(yes_no_p_value({1000000000, 5, 1, 1}) == Approx(6.9316236255267032e-10).epsilon(1e-10));
  CHECK(half_deviance_of_equal_rates({1000000, 500001, 1000000, 500000}) ==
        Approx(1.0000000000011667e-6).epsilon(1e-13));
}

TEST_CASE("exchanging answers or classes mirrors the yes-no model and nothing else", "[analysis]") {
  REQUIRE(rc::check("mirror images", [] {
    const Counts counts = some_counts();
    const DprimeProfile found = yes_no_profile(counts);
    const YesNo corrected = yes_no(counts, Correction::loglinear);
    for (const Counts& other : {answers_exchanged(counts), classes_exchanged(counts)}) {
      const DprimeProfile mirrored = yes_no_profile(other);
      RC_ASSERT(mirrored.status == found.status);
      RC_ASSERT(agrees(mirrored.dprime, -found.dprime, 0));
      RC_ASSERT(agrees(mirrored.ci_low, -found.ci_high, 1e-10));
      RC_ASSERT(agrees(mirrored.ci_high, -found.ci_low, 1e-10));
      RC_ASSERT(agrees(mirrored.log_likelihood, found.log_likelihood, 1e-10));
      RC_ASSERT(agrees(mirrored.p_value, found.p_value, 1e-12));
      RC_ASSERT(yes_no(other, Correction::loglinear).dprime == -corrected.dprime);
      RC_ASSERT(agrees(yes_no(other, Correction::loglinear).se, corrected.se, 1e-14));
    }
    // The answers change the sign of the criterion, the classes do not.
    RC_ASSERT(yes_no(answers_exchanged(counts), Correction::loglinear).criterion == -corrected.criterion);
    RC_ASSERT(yes_no(classes_exchanged(counts), Correction::loglinear).criterion == corrected.criterion);
    RC_ASSERT(agrees(corrected.ln_beta, corrected.criterion * corrected.dprime, 1e-12));
  }));
}

TEST_CASE("the profile interval holds its estimate, and 0 exactly where the test does not reject", "[analysis]") {
  REQUIRE(rc::check("interval and test agree", [] {
    const Counts counts = some_counts();
    const DprimeProfile found = yes_no_profile(counts);
    RC_ASSERT(found.p_value >= 0);
    RC_ASSERT(found.p_value <= 1);
    if (found.status == RateStatus::no_information) return;
    RC_ASSERT(found.ci_low < found.ci_high);
    RC_ASSERT(found.ci_low <= found.dprime);
    RC_ASSERT(found.dprime <= found.ci_high);
    RC_ASSERT((found.ci_low <= 0 && 0 <= found.ci_high) == (found.p_value >= 0.05));
  }));
}

TEST_CASE("more hits, larger yes-no d' and bounds", "[analysis]") {
  REQUIRE(rc::check("monotone in hits", [] {
    Counts counts = some_counts();
    if (counts.hits == counts.n_diff) --counts.hits;
    const DprimeProfile fewer = yes_no_profile(counts);
    const double corrected = yes_no(counts, Correction::loglinear).dprime;
    ++counts.hits;
    const DprimeProfile more = yes_no_profile(counts);
    RC_ASSERT(yes_no(counts, Correction::loglinear).dprime > corrected);
    RC_ASSERT(!(more.dprime < fewer.dprime));
    if (fewer.status != RateStatus::ok || more.status != RateStatus::ok) return;
    RC_ASSERT(more.ci_low >= fewer.ci_low);
    RC_ASSERT(more.ci_high >= fewer.ci_high);
  }));
}

TEST_CASE("the probit likelihood has the derivatives it says, in its far tails too", "[analysis]") {
  for (const double x : {-60.0, -31.0, -29.0, -5.0, -0.3, 0.0, 0.7, 6.0, 29.5, 45.0}) {
    CAPTURE(x);
    const double h = 1e-4;
    const ProbitLikelihood at = probit_log_likelihood(3, 7, x);
    const ProbitLikelihood left = probit_log_likelihood(3, 7, x - h), right = probit_log_likelihood(3, 7, x + h);
    CHECK(at.slope == Approx((right.value - left.value) / (2 * h)).epsilon(1e-6).margin(1e-6));
    CHECK(at.curvature == Approx((right.slope - left.slope) / (2 * h)).epsilon(1e-6).margin(1e-6));
    CHECK(at.curvature < 0);
  }
  // R 4.2.2: pnorm(-40, log.p = TRUE).
  CHECK(probit_log_likelihood(1, 1, -40).value == Approx(-804.608442013754).epsilon(1e-14));
}
