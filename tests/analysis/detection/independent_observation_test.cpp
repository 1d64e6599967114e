// d' of independent observation against R 4.2.2 and a second implementation (signal_detection_reference.json) and
// mpmath, and what must hold for any counts.
#include "analysis/detection/independent_observation.h"

#include <rapidcheck.h>

#include "analysis/detection/yes_no.h"
#include "analysis/numerics/normal.h"
#include "tests/analysis/detection/detection_fixtures.h"

using namespace jnd;
using namespace jnd::testing;

TEST_CASE("independent observation agrees with its reference", "[analysis]") {
  with_each_reference([](const Counts& counts, const nlohmann::json& one) {
    for (const auto& [correction, name] : {std::pair{Correction::loglinear, "independent_obs_loglinear"},
                                           {Correction::half, "independent_obs_half_n"}}) {
      CAPTURE(name);
      const IndependentObservation found = independent_observation(counts, correction);
      CHECK(agrees(found.unit_slope, one.at(name).at("unit_slope"), 1e-10));
      CHECK(agrees(found.exact, one.at(name).at("exact_lr"), 1e-6));
      CHECK(agrees(found.ln_criterion, one.at(name).at("exact_lr_ln_c"), 1e-6));
    }
  });
}

TEST_CASE("the likelihood-ratio observer with rates next to 0 and 1", "[analysis]") {
  // Log-linear rates of these counts; d' and ln c by quadrature in mpmath with 25 digits.
  struct Case {
    Counts counts;
    double dprime, ln_criterion;
  };
  for (const Case& one :
       {Case{{1000000, 1000000, 3, 1}, 5.78759603256, -12.00903563},
        Case{{20, 19, 20, 12}, 1.91616733779, -0.9602722257}, Case{{50, 3, 50, 1}, 0.901715041888, 0.6145388091},
        Case{{300, 299, 200, 3}, 5.18119999896, -1.104178678}, Case{{12, 12, 12, 0}, 4.12350979305, 0},
        Case{{40, 21, 40, 19}, 0.560887832712, 0}}) {
    const IndependentObservation found = independent_observation(one.counts, Correction::loglinear);
    CHECK(agrees(found.exact, one.dprime, 1e-9));
    CHECK(agrees(found.ln_criterion, one.ln_criterion, 1e-7));
  }
}

TEST_CASE("an unbiased likelihood-ratio observer is the unit-slope one", "[analysis]") {
  // pmax = Phi(d'/2)^2 + Phi(-d'/2)^2.
  for (const double dprime : {0.3, 1.0, 2.5, 5.0}) {
    const ObserverRates rates = likelihood_ratio_rates(dprime, 0);
    const double p = normal_cdf(0.5 * dprime), q = normal_cdf(-0.5 * dprime);
    CHECK(rates.hit == Approx(p * p + q * q).epsilon(1e-12));
    CHECK(rates.false_alarm == Approx(2 * p * q).epsilon(1e-11));
  }
}

TEST_CASE("independent observation of boundary rates", "[analysis]") {
  CHECK(unit_slope_dprime(0) == 0);
  CHECK(unit_slope_dprime(kInf) == kInf);
  CHECK(unit_slope_dprime(-kInf) == -kInf);
  CHECK(independent_observation({6, 6, 6, 2}, Correction::none).unit_slope == kInf);
  CHECK(std::isnan(independent_observation({6, 6, 6, 2}, Correction::none).exact));
  CHECK(std::isnan(independent_observation({6, 0, 6, 0}, Correction::none).unit_slope));
  CHECK(std::isnan(independent_observation({12, 7, 0, 0}, Correction::loglinear).unit_slope));
  CHECK(std::isnan(independent_observation({12, 7, 0, 0}, Correction::loglinear).exact));
  // Far out the root of 2 pmax - 1 rounds to 1.
  CHECK(std::isfinite(unit_slope_dprime(14)));
  CHECK(unit_slope_dprime(14) > 14);
}

TEST_CASE("exchanging answers or classes, and more hits, under independent observation", "[analysis]") {
  REQUIRE(rc::check("mirror images", [] {
    Counts counts = some_counts();
    const IndependentObservation found = independent_observation(counts, Correction::loglinear);
    for (const Counts& other : {answers_exchanged(counts), classes_exchanged(counts)}) {
      const IndependentObservation mirrored = independent_observation(other, Correction::loglinear);
      RC_ASSERT(mirrored.unit_slope == -found.unit_slope);
      RC_ASSERT(std::isnan(mirrored.exact) || std::isnan(found.exact));
    }
    // Both exchanges together leave the observer as he was, with the opposite criterion.
    const IndependentObservation both =
        independent_observation(answers_exchanged(classes_exchanged(counts)), Correction::loglinear);
    RC_ASSERT(both.unit_slope == found.unit_slope);
    RC_ASSERT(agrees(both.exact, found.exact, 1e-9));
    if (found.exact > 0.01) RC_ASSERT(agrees(both.ln_criterion, -found.ln_criterion, 1e-7));
    if (counts.hits == counts.n_diff) return;
    ++counts.hits;
    const IndependentObservation more = independent_observation(counts, Correction::loglinear);
    RC_ASSERT(more.unit_slope > found.unit_slope);
    RC_ASSERT(!(more.exact < found.exact));
  }));
}

TEST_CASE("the likelihood-ratio observer's rates come back from its d' and criterion", "[analysis]") {
  REQUIRE(rc::check("round trip", [] {
    const Counts counts = some_counts();
    const IndependentObservation found = independent_observation(counts, Correction::loglinear);
    if (std::isnan(found.exact)) return;
    const YesNo scores = yes_no(counts, Correction::loglinear);
    const ObserverRates rates = likelihood_ratio_rates(found.exact, found.ln_criterion);
    RC_ASSERT(agrees(rates.hit, scores.hit_rate, 1e-8));
    RC_ASSERT(agrees(rates.false_alarm, scores.false_alarm_rate, 1e-8));
  }));
}
