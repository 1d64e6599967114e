// The differencing model against sensR 1.5-3 (signal_detection_reference.json) and 40-digit arithmetic (mpmath), its
// boundary cases, and what must hold for any counts.
#include "analysis/detection/differencing.h"

#include <rapidcheck.h>

#include "analysis/detection/binomial_likelihood.h"
#include "analysis/detection/differencing_model.h"
#include "analysis/numerics/normal.h"
#include "tests/analysis/detection/detection_fixtures.h"

using namespace jnd;
using namespace jnd::testing;

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
