// d' of independent observation against R 4.2.2 and a second implementation (signal_detection_reference.json) and
// mpmath, and what must hold for any counts.
#include "analysis/detection/independent_observation.h"

#include <cmath>

#include <boost/math/quadrature/tanh_sinh.hpp>
#include <rapidcheck.h>

#include "analysis/detection/yes_no.h"
#include "analysis/numerics/normal.h"
#include "tests/analysis/detection/detection_fixtures.h"

using namespace jnd;
using namespace jnd::testing;

namespace {

struct ObserverRates {
  double hit, false_alarm;
};

// H and F of the likelihood-ratio observer by quadrature: "different" where ln cosh(delta u) > ln c + ln cosh(delta s), with
// u and s the difference and the sum of two sensations over the root of 2.
ObserverRates likelihood_ratio_rates(double dprime, double ln_c) {
  const double delta = dprime / std::sqrt(2.0);
  const auto ln_cosh = [](double x) {
    return x < 1 ? std::log1p(2 * std::pow(std::sinh(x / 2), 2)) : x + std::log1p(std::exp(-2 * x)) - std::log(2.0);
  };
  const auto inverse = [](double y) { return y > 0 ? y + std::log1p(std::sqrt(-std::expm1(-2 * y))) : 0; };
  const auto limit = [&](double s) { return inverse(ln_c + ln_cosh(delta * s)) / delta; };  // of |u|
  const double first = inverse(-ln_c) / delta;  // below this s every u is "different"
  boost::math::quadrature::tanh_sinh<double> quadrature;
  const auto above = [&](auto function) { return quadrature.integrate(function, first, first + delta + 10, 1e-12); };
  const auto density = [](double x) { return std::exp(-x * x / 2) / std::sqrt(2 * M_PI); };
  const double hit =
      above([&](double s) { return 2 * density(s) * (normal_cdf(delta - limit(s)) + normal_cdf(-delta - limit(s))); });
  const double alarm =
      above([&](double s) { return (density(s - delta) + density(s + delta)) * 2 * normal_cdf(-limit(s)); });
  return {std::erf(first / std::sqrt(2.0)) + hit,
          normal_cdf(first - delta) - normal_cdf(-delta) + normal_cdf(first + delta) - normal_cdf(delta) + alarm};
}

}  // namespace

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
    const double p = normal_cdf(0.5 * dprime), q = normal_cdf(-0.5 * dprime);
    const double hit = p * p + q * q, alarm = 2 * p * q;
    const ObserverRates rates = likelihood_ratio_rates(dprime, 0);
    CHECK(rates.hit == Approx(hit).epsilon(1e-10));
    CHECK(rates.false_alarm == Approx(alarm).epsilon(1e-10));
    const LikelihoodRatioObserver found = likelihood_ratio_observer(hit, alarm, alarm, hit);
    CHECK(found.dprime == Approx(dprime).epsilon(1e-9));
    CHECK(found.ln_criterion == Approx(0).margin(1e-9));
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
