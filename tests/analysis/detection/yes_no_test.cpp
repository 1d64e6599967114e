// The yes-no model: d', its error, interval, test and bootstrap.
#include "analysis/detection/yes_no.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <boost/math/distributions/binomial.hpp>
#include <rapidcheck.h>

#include "analysis/detection/binomial_likelihood.h"
#include "analysis/detection/coverage.h"
#include "analysis/detection/dprime_intervals.h"
#include "analysis/numerics/normal.h"
#include "analysis/numerics/profile_interval.h"
#include "analysis/numerics/special_values.h"
#include "tests/analysis/detection/detection_fixtures.h"
#include "tests/catch.h"

using namespace jnd;
using namespace jnd::testing;

// The exact bootstrap of d' against R 4.2.2 (signal_detection_reference.json), against a plain enumeration, and in the
// limit of many trials.

TEST_CASE("the exact bootstrap agrees with its reference", "[analysis]") {
  with_each_reference([](const Counts& counts, const nlohmann::json& one) {
    const DprimeBootstrap found = dprime_bootstrap(counts);
    const nlohmann::json& expected = one.at("exact_parametric_bootstrap_loglinear");
    CHECK(agrees(found.mean, expected.at("mean"), 1e-10));
    CHECK(agrees(found.sd, expected.at("sd"), 1e-10));
    CHECK(agrees(found.q025, expected.at("q025"), 1e-10));
    CHECK(agrees(found.q975, expected.at("q975"), 1e-10));
    // The reference adds up to the quantile alone, leaving out outcomes of the same d' that rounding puts behind it;
    // the plain enumeration below has them all.
    CHECK(found.p_q025 >= reference_number(expected.at("p_lower_at_q025")) - 1e-10);
    CHECK(found.p_q975 >= reference_number(expected.at("p_at_q975")) - 1e-10);
  });
}

TEST_CASE("the bootstrap is the distribution over all outcomes", "[analysis]") {
  REQUIRE(rc::check("plain enumeration", [] {
    const Counts counts = some_counts();
    const YesNo rates = yes_no(counts, Correction::loglinear);
    const boost::math::binomial hits(counts.n_diff, rates.hit_rate), alarms(counts.n_same, rates.false_alarm_rate);
    std::vector<std::pair<double, double>> outcomes;  // d', probability
    for (int h = 0; h <= counts.n_diff; ++h)
      for (int f = 0; f <= counts.n_same; ++f)
        outcomes.emplace_back(yes_no({counts.n_diff, h, counts.n_same, f}, Correction::loglinear).dprime,
                              pdf(hits, h) * pdf(alarms, f));
    std::sort(outcomes.begin(), outcomes.end());
    double mean = 0, square = 0, cumulative = 0, q025 = kInf, q975 = kInf;
    for (const auto& [dprime, probability] : outcomes) {
      mean += probability * dprime;
      square += probability * dprime * dprime;
      cumulative += probability;
      if (cumulative >= 0.025) q025 = std::fmin(q025, dprime);
      if (cumulative >= 0.975) q975 = std::fmin(q975, dprime);
    }
    const DprimeBootstrap found = dprime_bootstrap(counts);
    RC_ASSERT(agrees(found.mean, mean, 1e-10));
    RC_ASSERT(agrees(found.sd, std::sqrt(square - mean * mean), 1e-9));
    RC_ASSERT(agrees(found.q025, q025, 1e-10));
    RC_ASSERT(agrees(found.q975, q975, 1e-10));
    const auto up_to = [&](double value) {
      double sum = 0;
      for (const auto& [dprime, probability] : outcomes)
        if (dprime <= value + 1e-10) sum += probability;
      return sum;
    };
    RC_ASSERT(agrees(found.p_q025, up_to(q025), 1e-10));
    RC_ASSERT(agrees(found.p_q975, up_to(q975), 1e-10));
  }));
}

TEST_CASE("exchanging answers or classes mirrors the bootstrap", "[analysis]") {
  REQUIRE(rc::check("mirror images", [] {
    const Counts counts = some_counts();
    const DprimeBootstrap found = dprime_bootstrap(counts);
    for (const Counts& other : {answers_exchanged(counts), classes_exchanged(counts)}) {
      const DprimeBootstrap mirrored = dprime_bootstrap(other);
      RC_ASSERT(agrees(mirrored.mean, -found.mean, 1e-11));
      RC_ASSERT(agrees(mirrored.sd, found.sd, 1e-11));
      // Both quantiles are the upper end of their step.
      RC_ASSERT(mirrored.q025 >= -found.q975 - 1e-11);
      RC_ASSERT(mirrored.q975 >= -found.q025 - 1e-11);
    }
  }));
}

TEST_CASE("with very many trials the bootstrap is the normal approximation", "[analysis]") {
  const Counts counts{1000000, 700000, 400000, 100000};
  const YesNo rates = yes_no(counts, Correction::loglinear);
  const DprimeBootstrap found = dprime_bootstrap(counts);
  CHECK(found.mean == Approx(rates.dprime).margin(1e-5));
  CHECK(found.sd == Approx(rates.se).epsilon(1e-4));
  CHECK(found.q025 == Approx(rates.ci_low).margin(2e-5));
  CHECK(found.q975 == Approx(rates.ci_high).margin(2e-5));
}

TEST_CASE("no bootstrap without one class", "[analysis]") {
  const DprimeBootstrap found = dprime_bootstrap({12, 7, 0, 0});
  for (const double value : {found.mean, found.sd, found.q025, found.q975}) CHECK(std::isnan(value));
}

// Standard error, interval and test of the yes-no d' against R 4.2.2 (signal_detection_reference.json) and 40-digit
// arithmetic (mpmath 1.x), and what must hold for any counts.

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

// How often intervals and tests are right: exact sums, small cases by hand, and the nominal values for many trials.

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

namespace jnd {
namespace {

// d' of the yes-no model against numbers computed with R 4.2.2 (qnorm; checked with psyphy::dprime.SD and a second
// implementation), and what its statuses mean.

// Equal, both infinite alike, both undefined, or within the tolerance for closed forms.
bool agrees(double ours, double reference) {
  if (std::isnan(reference)) return std::isnan(ours);
  return ours == reference || std::abs(ours - reference) <= 1e-10;
}

struct Expected {
  double hit_rate, false_alarm_rate, z_hit, z_false_alarm, dprime, criterion;
};
struct Case {
  Counts counts;
  std::array<Expected, 3> by_correction;  // none, loglinear, half
};

// n_diff, hits, n_same, false alarms -> H, F, zH, zF, d', c (R 4.2.2, 15 digits).
const std::vector<Case> kReference = {
    {{6, 5, 6, 1},
     {{{0.833333333333333, 0.166666666666667, 0.967421566101701, -0.967421566101701, 1.9348431322034, 0},
       {0.785714285714286, 0.214285714285714, 0.791638607743375, -0.791638607743375, 1.58327721548675, 0},
       {0.833333333333333, 0.166666666666667, 0.967421566101701, -0.967421566101701, 1.9348431322034, 0}}}},
    {{6, 6, 6, 2},
     {{{1, 0.333333333333333, kInf, -0.430727299295457, kInf, -kInf},
       {0.928571428571429, 0.357142857142857, 1.46523379268552, -0.36610635680057, 1.83134014948609,
        -0.549563717942476},
       {0.916666666666667, 0.333333333333333, 1.38299412710064, -0.430727299295457, 1.8137214263961,
        -0.47613341390259}}}},
    {{6, 3, 6, 3}, {{{0.5, 0.5, 0, 0, 0, 0}, {0.5, 0.5, 0, 0, 0, 0}, {0.5, 0.5, 0, 0, 0, 0}}}},
    {{6, 2, 6, 4},
     {{{0.333333333333333, 0.666666666666667, -0.430727299295457, 0.430727299295457, -0.861454598590915,
        5.55111512312578e-17},
       {0.357142857142857, 0.642857142857143, -0.36610635680057, 0.36610635680057, -0.732212713601139, 0},
       {0.333333333333333, 0.666666666666667, -0.430727299295457, 0.430727299295457, -0.861454598590915,
        5.55111512312578e-17}}}},
    {{6, 0, 6, 0},
     {{{0, 0, -kInf, -kInf, kNaN, kInf},
       {0.0714285714285714, 0.0714285714285714, -1.46523379268552, -1.46523379268552, 0, 1.46523379268552},
       {0.0833333333333333, 0.0833333333333333, -1.38299412710064, -1.38299412710064, 0, 1.38299412710064}}}},
    {{6, 6, 6, 6},
     {{{1, 1, kInf, kInf, kNaN, -kInf},
       {0.928571428571429, 0.928571428571429, 1.46523379268552, 1.46523379268552, 0, -1.46523379268552},
       {0.916666666666667, 0.916666666666667, 1.38299412710064, 1.38299412710064, 0, -1.38299412710064}}}},
    {{18, 15, 18, 4},
     {{{0.833333333333333, 0.222222222222222, 0.967421566101701, -0.764709673786387, 1.73213123988809,
        -0.101355946157657},
       {0.815789473684211, 0.236842105263158, 0.899434907667234, -0.716497500177991, 1.61593240784523,
        -0.0914687037446212},
       {0.833333333333333, 0.222222222222222, 0.967421566101701, -0.764709673786387, 1.73213123988809,
        -0.101355946157657}}}},
    {{200, 150, 200, 30},
     {{{0.75, 0.15, 0.674489750196082, -1.03643338949379, 1.71092313968987, 0.180971819648854},
       {0.748756218905473, 0.151741293532338, 0.670580886297182, -1.02899380267607, 1.69957468897326,
        0.179206458189446},
       {0.75, 0.15, 0.674489750196082, -1.03643338949379, 1.71092313968987, 0.180971819648854}}}},
    {{36, 36, 36, 5},
     {{{1, 0.138888888888889, kInf, -1.08532490807676, kInf, -kInf},
       {0.986486486486487, 0.148648648648649, 2.21112724108533, -1.04224674183241, 3.25337398291774, -0.58444024962646},
       {0.986111111111111, 0.138888888888889, 2.20041058121003, -1.08532490807676, 3.28573548928679,
        -0.557542836566637}}}},
    {{6, 5, 6, 0},
     {{{0.833333333333333, 0, 0.967421566101701, -kInf, kInf, kInf},
       {0.785714285714286, 0.0714285714285714, 0.791638607743375, -1.46523379268552, 2.2568724004289,
        0.336797592471074},
       {0.833333333333333, 0.0833333333333333, 0.967421566101701, -1.38299412710064, 2.35041569320234,
        0.207786280499469}}}},
};

TEST_CASE("yes-no rates, z scores, d' and criterion agree with R under every correction", "[analysis]") {
  for (const Case& one : kReference) {
    std::size_t place = 0;
    for (const Correction correction : {Correction::none, Correction::loglinear, Correction::half}) {
      CAPTURE(one.counts.n_diff, one.counts.hits, one.counts.n_same, one.counts.false_alarms, to_string(correction));
      const Expected& expected = one.by_correction[place++];
      const YesNo found = yes_no(one.counts, correction);
      CHECK(found.correction == correction);
      CHECK(agrees(found.hit_rate, expected.hit_rate));
      CHECK(agrees(found.false_alarm_rate, expected.false_alarm_rate));
      CHECK(agrees(found.z_hit, expected.z_hit));
      CHECK(agrees(found.z_false_alarm, expected.z_false_alarm));
      CHECK(agrees(found.dprime, expected.dprime));
      CHECK(agrees(found.criterion, expected.criterion));
      CHECK(found.raw_hit_rate == Approx(static_cast<double>(one.counts.hits) / one.counts.n_diff));
    }
  }
}

TEST_CASE("a row without one class is missing, and never a pseudo-value", "[analysis]") {
  for (const Counts& counts : {Counts{12, 7, 0, 0}, Counts{0, 0, 12, 3}, Counts{}}) {
    for (const Correction correction : {Correction::none, Correction::loglinear, Correction::half}) {
      const YesNo found = yes_no(counts, correction);
      CHECK(found.status == RateStatus::missing);
      for (const double value : {found.raw_hit_rate, found.raw_false_alarm_rate, found.hit_rate, found.false_alarm_rate,
                                 found.z_hit, found.z_false_alarm, found.dprime, found.criterion})
        CHECK(std::isnan(value));
    }
  }
}

TEST_CASE("one and the same answer throughout is no information, with the arithmetic of the corrected rates",
          "[analysis]") {
  for (const Counts& counts : {Counts{6, 0, 6, 0}, Counts{6, 6, 6, 6}}) {
    CHECK(yes_no(counts, Correction::loglinear).status == RateStatus::no_information);
    CHECK(yes_no(counts, Correction::loglinear).dprime == 0);
    CHECK(yes_no(counts, Correction::half).dprime == 0);
    CHECK(yes_no(counts, Correction::none).status == RateStatus::no_information);
    CHECK(std::isnan(yes_no(counts, Correction::none).dprime));
  }
  CHECK(yes_no({6, 6, 6, 0}, Correction::none).status == RateStatus::ok);
  CHECK(yes_no({6, 0, 6, 6}, Correction::none).dprime == -kInf);
}

TEST_CASE("corrections touch what they say and nothing else", "[analysis]") {
  CHECK(corrected_rate(3, 6, Correction::none) == 0.5);
  CHECK(corrected_rate(3, 6, Correction::half) == 0.5);
  CHECK(corrected_rate(0, 6, Correction::half) == Approx(1.0 / 12));
  CHECK(corrected_rate(6, 6, Correction::half) == Approx(11.0 / 12));
  CHECK(corrected_rate(2, 6, Correction::loglinear) == Approx(2.5 / 7));
  for (const Correction correction : {Correction::none, Correction::loglinear, Correction::half})
    CHECK(correction_from(to_string(correction)) == correction);
  CHECK_FALSE(correction_from("log-linear").has_value());
}

TEST_CASE("normal quantile and distribution are inverses, with their edges", "[analysis]") {
  // R 4.2.2: qnorm(0.975), qnorm(1e-10), pnorm(-8).
  CHECK(normal_quantile(0.975) == Approx(1.95996398454005).epsilon(1e-14));
  CHECK(normal_quantile(1e-10) == Approx(-6.36134090240406).epsilon(1e-14));
  CHECK(normal_cdf(-8) == Approx(6.22096057427178e-16).epsilon(1e-13));
  CHECK(normal_quantile(0) == -kInf);
  CHECK(normal_quantile(1) == kInf);
  CHECK(std::isnan(normal_quantile(-0.1)));
  CHECK(std::isnan(normal_quantile(kNaN)));
  for (double p = 0.001; p < 1; p += 0.001) CHECK(normal_cdf(normal_quantile(p)) == Approx(p).epsilon(1e-13));
}

}  // namespace
}  // namespace jnd
