// Same-different: the differencing model and independent observation.
#include "analysis/detection/differencing.h"

#include <cmath>

#include <boost/math/quadrature/tanh_sinh.hpp>
#include <rapidcheck.h>

#include "analysis/detection/binomial_likelihood.h"
#include "analysis/detection/differencing_model.h"
#include "analysis/detection/independent_observation.h"
#include "analysis/detection/yes_no.h"
#include "analysis/numerics/normal.h"
#include "tests/analysis/detection/detection_fixtures.h"

using namespace jnd;
using namespace jnd::testing;

// The differencing model against sensR 1.5-3 (signal_detection_reference.json) and 40-digit arithmetic (mpmath), its
// boundary cases, and what must hold for any counts.

TEST_CASE("maximum likelihood of the differencing model agrees with sensR", "[analysis]") {
  with_each_reference([](const Counts& counts, const nlohmann::json& one) {
    const Differencing found = differencing(counts);
    const nlohmann::json& expected = one.at("differencing_ml_raw");
    CHECK(to_string(found.fit.status) == expected.at("status").get<std::string>());
    if (found.fit.status != DifferencingStatus::ok) return;
    // Where d' is at a boundary sensR maximises over tau numerically and stops early; there tau is compared exactly
    // below.
    const bool interior = std::isfinite(found.fit.dprime) && found.fit.dprime > 0;
    CHECK(agrees(found.fit.dprime, expected.at("delta"), 1e-8));
    CHECK(agrees(found.fit.tau, expected.at("tau"), interior ? 1e-8 : 5e-5));
    CHECK(agrees(found.fit.se_dprime, expected.at("se_delta"), 1e-8));
    CHECK(agrees(found.fit.se_tau, expected.at("se_tau"), interior ? 1e-8 : 1e-5));
    CHECK(agrees(found.fit.log_likelihood, expected.at("logLik_exact"), 1e-10));
    CHECK(agrees(found.ci_low, expected.at("profile_delta_lo"), 1e-6));
    CHECK(agrees(found.ci_high, expected.at("profile_delta_hi"), 1e-6));
    CHECK(agrees(found.tau_low, expected.at("profile_tau_lo"), 1e-6));
    CHECK(agrees(found.tau_high, expected.at("profile_tau_hi"), 1e-6));
    CHECK(agrees(found.p_value, expected.at("p_one_sided"), 1e-9));
    CHECK(found.p_value == Approx(reference_number(expected.at("p_one_sided"))).epsilon(1e-9));  // far tails too
    CHECK(agrees(-normal_quantile(found.p_value), expected.at("signed_root_LR_z"), 1e-6));
  });
}

TEST_CASE("the differencing model solved for corrected rates", "[analysis]") {
  with_each_reference([](const Counts& counts, const nlohmann::json& one) {
    for (const auto& [correction, name] :
         {std::pair{Correction::loglinear, "differencing_loglinear"}, {Correction::half, "differencing_half_n"}}) {
      CAPTURE(name);
      const DifferencingFit found = differencing_of_rates(counts, correction);
      const nlohmann::json& expected = one.at(name);
      CHECK(agrees(found.dprime, expected.at("dprime"), 1e-8));
      CHECK(agrees(found.tau, expected.at("tau"), 1e-10));
      if (expected.contains("se_dprime")) CHECK(agrees(found.se_dprime, expected.at("se_dprime"), 1e-8));
      if (expected.contains("se_tau")) CHECK(agrees(found.se_tau, expected.at("se_tau"), 1e-8));
      const bool one_answer = one.at("yesno_profile95").at("no_information");
      const bool solved = expected.at("status") == "ok";
      CHECK(found.status == (one_answer ? DifferencingStatus::no_information
                             : solved   ? DifferencingStatus::ok
                                        : DifferencingStatus::no_sensitivity));
    }
  });
}

TEST_CASE("differencing boundary cases", "[analysis]") {
  // No false alarms: both infinite.
  for (const Counts& counts : {Counts{6, 5, 6, 0}, Counts{6, 6, 6, 0}, Counts{1, 1, 1, 0}}) {
    const Differencing found = differencing(counts);
    CHECK(found.fit.status == DifferencingStatus::ok);
    CHECK(found.fit.dprime == kInf);
    CHECK(found.fit.tau == kInf);
    CHECK(found.ci_high == kInf);
    CHECK(std::isfinite(found.ci_low));
    CHECK(std::isnan(found.fit.se_dprime));
    CHECK(std::isnan(found.fit.se_tau));
  }
  // Only hits: tau from F alone. F = 1/3 (R 4.2.2: -sqrt(2) * qnorm(1/6)).
  CHECK(differencing({6, 6, 6, 2}).fit.tau == Approx(1.36814069931325).epsilon(1e-14));
  CHECK(differencing({6, 6, 6, 2}).fit.dprime == kInf);
  // H <= F: d' = 0, tau from the pooled rate 1/2 (-sqrt(2) * qnorm(1/4)).
  for (const Counts& counts : {Counts{6, 3, 6, 3}, Counts{6, 2, 6, 4}, Counts{3, 0, 3, 3}}) {
    const Differencing found = differencing(counts);
    CHECK(found.fit.status == DifferencingStatus::ok);
    CHECK(found.fit.dprime == 0);
    CHECK(found.fit.tau == Approx(0.95387255240894).epsilon(1e-14));
    CHECK(found.p_value == 0.5);
    CHECK(found.ci_low == 0);
    CHECK(std::isfinite(found.ci_high));
    CHECK(std::isnan(found.fit.se_dprime));
    CHECK(found.fit.log_likelihood == Approx((counts.n_diff + counts.n_same) * std::log(0.5)));
  }
  // Corrected rates with H <= F: tau from the corrected F alone, 4.5/7 (-sqrt(2) * qnorm(4.5/14)).
  CHECK(differencing_of_rates({6, 2, 6, 4}, Correction::loglinear).tau == Approx(0.655781791088275).epsilon(1e-13));
}

TEST_CASE("one answer throughout, or one class: no differencing d'", "[analysis]") {
  for (const Counts& counts : {Counts{6, 0, 6, 0}, Counts{6, 6, 6, 6}, Counts{12, 7, 0, 0}, Counts{0, 0, 3, 1}}) {
    const Differencing found = differencing(counts);
    const bool missing = counts.n_diff == 0 || counts.n_same == 0;
    CHECK(found.fit.status == (missing ? DifferencingStatus::missing : DifferencingStatus::no_information));
    for (const double value :
         {found.fit.dprime, found.fit.tau, found.fit.se_dprime, found.fit.se_tau, found.fit.log_likelihood,
          found.ci_low, found.ci_high, found.tau_low, found.tau_high, found.p_value})
      CHECK(std::isnan(value));
    const DifferencingFit corrected = differencing_of_rates(counts, Correction::loglinear);
    CHECK(corrected.status == found.fit.status);
    CHECK(std::isnan(corrected.dprime) == missing);
  }
}

TEST_CASE("differencing keeps its digits with very many trials and rates next to 0, to 1 and to each other",
          "[analysis]") {
  // mpmath, 40 digits.
  struct Case {
    Counts counts;
    double dprime, tau;
  };
  for (const Case& one :
       {Case{{1000000, 999999, 1000000, 999998}, 1.6651092223171392, 3.5449077018147443e-6},
        Case{{1000000000, 999999999, 1000000000, 999999998}, 1.6651092223153955, 3.5449077018110321e-9},
        Case{{1000000, 500001, 1000000, 500000}, 0.0030546861594576442, 0.95387255240893975},
        Case{{1000000000, 500000000, 999999999, 499999999}, 6.8304825259899396e-5, 0.95387255352152457},
        Case{{1000000, 999999, 1000000, 1}, 13.640178599810299, 6.917821474559},
        Case{{1000000, 2, 1000000, 1}, 0.37748748114965423, 6.917821474559},
        Case{{2000, 1999, 3, 2}, 5.2491898024447272, 0.60914038834797125}}) {
    CAPTURE(one.counts.n_diff, one.counts.hits, one.counts.false_alarms);
    const DifferencingFit found = differencing_fit(one.counts);
    CHECK(found.dprime == Approx(one.dprime).epsilon(1e-12));
    CHECK(found.tau == Approx(one.tau).epsilon(1e-13));
  }
  CHECK(agrees(differencing({1000000, 999999, 1000000, 1}).ci_low, 12.98975389476186, 1e-11));
  CHECK(agrees(differencing({1000000, 999999, 1000000, 1}).ci_high, 14.619659182774571, 1e-11));
  CHECK(agrees(differencing({1000000, 999999, 1000000, 999998}).ci_high, 3.8788193991533332, 1e-11));
  CHECK(agrees(differencing({1000000, 1000000, 3, 1}).ci_low, 7.2339133211412196, 1e-11));
}

TEST_CASE("the differencing fit gives the observed rates back", "[analysis]") {
  REQUIRE(rc::check("rates", [] {
    const Counts counts = some_counts();
    const DifferencingFit fit = differencing_fit(counts);
    if (fit.status != DifferencingStatus::ok || !(fit.dprime > 0) || std::isinf(fit.dprime)) return;
    const DifferencingRates rates = differencing_rates(fit.dprime, fit.tau);
    RC_ASSERT(agrees(rates.hit * counts.n_diff, counts.hits, 1e-10));
    RC_ASSERT(agrees(rates.false_alarm * counts.n_same, counts.false_alarms, 1e-10));
    RC_ASSERT(agrees(rates.hit + rates.miss, 1, 1e-14));
    RC_ASSERT(agrees(fit.log_likelihood, differencing_log_likelihood(counts, fit.dprime, fit.tau), 1e-9));
  }));
}

TEST_CASE("exchanging answers or classes takes differencing to its boundary", "[analysis]") {
  // The model has no d' below 0, and its ROC is not symmetric: only the test's deviance survives an exchange.
  REQUIRE(rc::check("H > F becomes H < F", [] {
    const Counts counts = some_counts();
    RC_ASSERT(agrees(half_deviance_of_equal_rates(answers_exchanged(counts)), half_deviance_of_equal_rates(counts),
                     1e-12 * (1 + half_deviance_of_equal_rates(counts))));
    RC_ASSERT(agrees(half_deviance_of_equal_rates(classes_exchanged(counts)), half_deviance_of_equal_rates(counts),
                     1e-12 * (1 + half_deviance_of_equal_rates(counts))));
    const DifferencingFit fit = differencing_fit(counts);
    if (fit.status != DifferencingStatus::ok || fit.dprime == 0) return;
    for (const Counts& other : {answers_exchanged(counts), classes_exchanged(counts)}) {
      const Differencing mirrored = differencing(other);
      RC_ASSERT(mirrored.fit.dprime == 0);
      RC_ASSERT(mirrored.p_value == 0.5);
      RC_ASSERT(agrees(mirrored.fit.log_likelihood, pooled_log_likelihood(counts), 1e-9));
    }
  }));
}

TEST_CASE("differencing intervals hold their estimates, and 0 exactly where the test does not reject", "[analysis]") {
  REQUIRE(rc::check("interval and test agree", [] {
    const Differencing found = differencing(some_counts());
    if (found.fit.status != DifferencingStatus::ok) return;
    RC_ASSERT(found.p_value >= 0);
    RC_ASSERT(found.p_value <= 0.5);
    RC_ASSERT(0 <= found.ci_low);
    RC_ASSERT(found.ci_low <= found.fit.dprime);
    RC_ASSERT(found.fit.dprime <= found.ci_high);
    RC_ASSERT(found.ci_low < found.ci_high);
    RC_ASSERT(0 < found.tau_low);
    RC_ASSERT(found.tau_low <= found.fit.tau);
    RC_ASSERT(found.fit.tau <= found.tau_high);
    // A drop of 1.92 above 0 is a one-sided p of 0.025.
    RC_ASSERT((found.ci_low == 0) == (found.p_value >= 0.025));
  }));
}

TEST_CASE("more hits, larger differencing d' and bounds, smaller p", "[analysis]") {
  REQUIRE(rc::check("monotone in hits", [] {
    Counts counts = some_counts();
    if (counts.hits == counts.n_diff) --counts.hits;
    const Differencing fewer = differencing(counts);
    ++counts.hits;
    const Differencing more = differencing(counts);
    if (fewer.fit.status != DifferencingStatus::ok || more.fit.status != DifferencingStatus::ok) return;
    RC_ASSERT(more.fit.dprime >= fewer.fit.dprime);
    RC_ASSERT(more.p_value <= fewer.p_value);
    RC_ASSERT(more.ci_low >= fewer.ci_low);
    RC_ASSERT(more.ci_high >= fewer.ci_high);
  }));
}

TEST_CASE("the profile of differencing d' has fallen by 1.92 at its bounds, over all tau", "[analysis]") {
  REQUIRE(rc::check("drop", [] {
    const Counts counts = some_counts();
    const Differencing found = differencing(counts);
    if (found.fit.status != DifferencingStatus::ok) return;
    // A dense look at tau, so that another maximum would be found.
    const auto best = [&](double dprime) {
      double value = -kInf;
      for (double log_tau = -9; log_tau < 3; log_tau += 0.004)
        value = std::fmax(value, differencing_log_likelihood(counts, dprime, std::exp(log_tau)));
      return value;
    };
    for (const double bound : {found.ci_low, found.ci_high})
      if (bound > 0 && std::isfinite(bound))
        RC_ASSERT(agrees(found.fit.log_likelihood - best(bound), 1.9207294103470621, 1e-3));
  }));
}

TEST_CASE("the derivatives of the differencing likelihood", "[analysis]") {
  const Counts counts{12, 9, 14, 4};
  for (const double dprime : {0.2, 1.7, 4.0})
    for (const double tau : {0.05, 0.8, 3.0}) {
      CAPTURE(dprime, tau);
      const double h = 1e-5;
      const DifferencingLikelihood at = differencing_likelihood(counts, dprime, tau);
      const DifferencingLikelihood more = differencing_likelihood(counts, dprime, tau + h);
      const DifferencingLikelihood less = differencing_likelihood(counts, dprime, tau - h);
      CHECK(at.value == Approx(differencing_log_likelihood(counts, dprime, tau)).epsilon(1e-14));
      CHECK(at.on_tau == Approx((more.value - less.value) / (2 * h)).epsilon(1e-5).margin(1e-5));
      CHECK(at.on_tau_twice == Approx((more.on_tau - less.on_tau) / (2 * h)).epsilon(1e-5).margin(1e-5));
      CHECK(at.on_dprime_and_tau == Approx((more.on_dprime - less.on_dprime) / (2 * h)).epsilon(1e-5).margin(1e-5));
      CHECK(at.on_dprime == Approx((differencing_log_likelihood(counts, dprime + h, tau) -
                                    differencing_log_likelihood(counts, dprime - h, tau)) /
                                   (2 * h))
                                .epsilon(1e-5)
                                .margin(1e-5));
      CHECK(at.information_on_tau > 0);
    }
}

TEST_CASE("differencing rates at the edges", "[analysis]") {
  CHECK(differencing_hit_rate(0, 0.7) == Approx(differencing_rates(1, 0.7).false_alarm).epsilon(1e-15));
  CHECK(differencing_hit_rate(kInf, 2) == 1);
  CHECK(differencing_hit_rate(3, 0) == 1);
  CHECK(differencing_rates(kInf, 2).miss == 0);
  CHECK(differencing_rates(1, kInf).false_alarm == 0);
  CHECK(differencing_tau(0, 1) == kInf);
  CHECK(differencing_tau(1, 0) == 0);
  // Just either side of the change between formulas.
  CHECK(differencing_rates(3, 0.12499).miss / 0.12499 ==
        Approx(differencing_rates(3, 0.12501).miss / 0.12501).epsilon(1e-5));
  CHECK(differencing_rates(2, 1.999999).miss == Approx(differencing_rates(2, 2.000001).miss).epsilon(1e-5));
}

// d' of independent observation against R 4.2.2 and a second implementation (signal_detection_reference.json) and
// mpmath, and what must hold for any counts.

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
