// The exact bootstrap of d' against R 4.2.2 (signal_detection_reference.json), against a plain enumeration, and in the
// limit of many trials.
#include <algorithm>
#include <vector>

#include <boost/math/distributions/binomial.hpp>
#include <rapidcheck.h>

#include "analysis/detection/dprime_intervals.h"
#include "analysis/detection/yes_no.h"
#include "analysis/numerics/normal.h"
#include "tests/analysis/detection/detection_fixtures.h"

using namespace jnd;
using namespace jnd::testing;

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
