// Joint maximum likelihood: data at the boundary, and a plain oracle with random counts.
#include "analysis/thresholds/jnd_ml.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <rapidcheck.h>

#include "analysis/numerics/normal.h"
#include "analysis/numerics/profile_interval.h"
#include "analysis/numerics/special_values.h"
#include "analysis/thresholds/jnd_ml_differencing.h"
#include "tests/analysis/thresholds/jnd_ml_oracle.h"
#include "tests/catch.h"

namespace jnd {
namespace {

constexpr JndMethod kYesNoCommon = JndMethod::ml_yes_no_common, kYesNoSeries = JndMethod::ml_yes_no_series,
                    kDiffCommon = JndMethod::ml_differencing_common, kDiffSeries = JndMethod::ml_differencing_series;
constexpr JndMethod kAll[] = {kYesNoCommon, kYesNoSeries, kDiffCommon, kDiffSeries};

JndEstimate estimate(const std::vector<SeriesCounts>& series, JndMethod method) {
  return estimate_jnd(series, 900, method, Correction::loglinear);
}

TEST_CASE("rates of 0 and 1 in some series leave a finite slope where another series bounds it", "[analysis][jnd]") {
  // The first series alone would be at the ceiling (every hit), the second bounds the slope.
  const std::vector<SeriesCounts> series = {{400, {6, 6, 6, 1}}, {200, {6, 4, 6, 2}}};
  for (const JndMethod method : kAll) {
    const JndEstimate found = estimate(series, method);
    CHECK(found.status == JndStatus::ok);
    CHECK(std::isfinite(found.slope_ci_high));
    CHECK(found.slope == Approx(oracle::best_slope(series, method, 0, 0.1)).epsilon(1e-6));
  }
  // A series without any false alarm: its own criterion, not the slope, wants to be infinite.
  const std::vector<SeriesCounts> no_false_alarm = {{400, {6, 4, 6, 0}}, {200, {6, 3, 6, 2}}};
  for (const JndMethod method : kAll)
    CHECK(estimate(no_false_alarm, method).slope ==
          Approx(oracle::best_slope(no_false_alarm, method, 0, 0.1)).epsilon(1e-6));
}

TEST_CASE("separated answers are the ceiling, decided from the counts", "[analysis][jnd]") {
  struct Separated {
    std::vector<SeriesCounts> series;
    bool common, each;  // at the ceiling with one criterion; with a criterion for each series
  };
  const std::vector<Separated> all = {
      {{{400, {6, 6, 6, 0}}, {200, {6, 6, 6, 0}}}, true, true},   // no mistake
      {{{400, {6, 6, 6, 2}}, {200, {6, 6, 6, 1}}}, true, true},   // every hit
      {{{400, {6, 6, 6, 0}}, {200, {6, 2, 6, 0}}}, true, true},   // no false alarm; one criterion at 200
      {{{400, {6, 5, 6, 0}}, {200, {6, 2, 6, 0}}}, false, true},  // no false alarm, misses at both
      {{{400, {6, 6, 6, 0}}, {200, {6, 0, 6, 0}}}, true, true},   // found at 400, never at 200
      {{{400, {6, 6, 6, 3}}, {200, {6, 6, 6, 0}}}, true, true},
      {{{400, {6, 6, 6, 3}}, {200, {6, 4, 6, 0}}}, false, true},
      {{{400, {6, 6, 6, 3}}, {200, {6, 4, 6, 1}}}, false, false},
      {{{400, {6, 6, 6, 6}}, {200, {6, 6, 6, 0}}}, true, true},  // the first says nothing by itself
  };
  for (const Separated& one : all) {
    CAPTURE(one.series[0].counts.hits, one.series[0].counts.false_alarms, one.series[1].counts.hits,
            one.series[1].counts.false_alarms);
    for (const JndMethod method : kAll) {
      CAPTURE(to_string(method));
      const JndEstimate found = estimate(one.series, method);
      const bool ceiling = method == kYesNoCommon || method == kDiffCommon ? one.common : one.each;
      CHECK((found.status == JndStatus::ceiling) == ceiling);
      if (!ceiling) continue;
      CHECK(found.slope == kInf);
      CHECK(found.jnd == 0);
      CHECK(found.weber == 0);
      CHECK(found.ci_low == 0);
      CHECK(found.slope_ci_high == kInf);
      // The limit of the likelihood, and the lower bound where the profile has risen to 1.92 below it.
      const double far = oracle::profile(one.series, method, 20.0 / 200);
      CHECK(found.log_likelihood == Approx(far).margin(3e-3));
      if (found.slope_ci_low != 0)
        CHECK(oracle::profile(one.series, method, found.slope_ci_low) ==
              Approx(found.log_likelihood - kProfileDrop).epsilon(1e-7));
    }
  }
}

TEST_CASE("answers the wrong way round are no sensitivity, and their upper bound bounds the JND from below",
          "[analysis][jnd]") {
  const std::vector<SeriesCounts> worse = {{400, {6, 2, 6, 4}}, {200, {6, 2, 6, 4}}};
  for (const JndMethod method : {kYesNoCommon, kYesNoSeries}) {
    const JndEstimate found = estimate(worse, method);
    CHECK(found.status == JndStatus::no_sensitivity);
    CHECK(found.slope < 0);
    CHECK(std::isnan(found.jnd));
    CHECK(std::isnan(found.weber));
    CHECK(found.slope_ci_high > 0);
    CHECK(found.ci_low == Approx(1 / found.slope_ci_high));
    CHECK(found.ci_high == kInf);
  }
  for (const JndMethod method : {kDiffCommon, kDiffSeries}) {
    const JndEstimate found = estimate(worse, method);
    CHECK(found.status == JndStatus::no_sensitivity);
    CHECK(found.slope == 0);  // exactly: m = 0 is stationary, and a maximum here
    CHECK(found.slope_ci_low == 0);
    CHECK(found.ci_low == Approx(1 / found.slope_ci_high));
  }
  // Only wrong answers: the mirror image of the ceiling. No positive slope is likely at all.
  const std::vector<SeriesCounts> only_wrong = {{400, {6, 0, 6, 6}}, {200, {6, 0, 6, 6}}};
  const JndEstimate wrong = estimate(only_wrong, kYesNoSeries);
  CHECK(wrong.status == JndStatus::no_sensitivity);
  CHECK(wrong.slope == -kInf);
  CHECK(wrong.slope_ci_low == -kInf);
  CHECK(wrong.slope_ci_high < 0);
  CHECK(wrong.ci_low == kInf);
  CHECK(wrong.log_likelihood == 0);
  CHECK(estimate(only_wrong, kDiffSeries).slope == 0);
}

TEST_CASE("equal rates are a slope of zero, not a rounding zero", "[analysis][jnd]") {
  const std::vector<SeriesCounts> equal = {{400, {12, 5, 12, 5}}, {300, {7, 3, 14, 6}}, {200, {6, 3, 6, 3}}};
  for (const JndMethod method : kAll) {
    if (method == kYesNoCommon || method == kDiffCommon) continue;  // there the series differ in their rates
    const JndEstimate found = estimate(equal, method);
    CHECK(found.status == JndStatus::no_sensitivity);
    CHECK(std::abs(found.slope) < 1e-9);
    CHECK(std::isnan(found.jnd));
  }
}

TEST_CASE("constant answers say nothing; a missing series is left out and named", "[analysis][jnd]") {
  const std::vector<SeriesCounts> constant = {{400, {6, 0, 6, 0}}, {200, {6, 0, 6, 0}}};
  for (const JndMethod method : kAll) {
    const JndEstimate found = estimate(constant, method);
    CHECK(found.status == JndStatus::no_information);
    CHECK(std::isnan(found.slope));
    CHECK(found.slope_ci_low == (method == kDiffCommon || method == kDiffSeries ? 0 : -kInf));
    CHECK(found.slope_ci_high == kInf);
    CHECK(found.ci_low == 0);
    CHECK(found.ci_high == kInf);
    CHECK(found.log_likelihood == 0);

    const JndEstimate none = estimate({{400, {6, 4, 0, 0}}}, method);
    CHECK(none.status == JndStatus::no_information);
    CHECK(none.series_used == 0);
    CHECK(std::isnan(none.ci_low));
    CHECK(std::isnan(none.log_likelihood));
    CHECK(none.cautions == std::vector<Caution>{Caution::series_missing});

    const SeriesCounts good{300, {20, 14, 20, 5}};
    const JndEstimate alone = estimate({good}, method), beside = estimate({{400, {12, 7, 0, 0}}, good}, method);
    CHECK(beside.slope == alone.slope);
    CHECK(beside.series_used == 1);
    CHECK(std::count(beside.cautions.begin(), beside.cautions.end(), Caution::series_missing) == 1);
  }
  // A series of one answer has no say with a criterion of its own, and has one where the criterion is common.
  const SeriesCounts good{300, {20, 14, 20, 5}}, same{200, {20, 0, 20, 0}};
  for (const JndMethod method : {kYesNoSeries, kDiffSeries})
    CHECK(estimate({good, same}, method).slope == Approx(estimate({good}, method).slope).epsilon(1e-12));
  for (const JndMethod method : {kYesNoCommon, kDiffCommon})
    CHECK(std::abs(estimate({good, same}, method).slope / estimate({good}, method).slope - 1) > 0.01);
}

TEST_CASE("a differencing likelihood with two maxima gives the higher one and an interval over both",
          "[analysis][jnd]") {
  // Two series that contradict each other: one finds nothing, one nearly everything.
  for (const int n : {10, 20, 40}) {
    const std::vector<SeriesCounts> series = {{400, {n, n / 2, n, n / 2}}, {20, {30, 26, 30, 3}}};
    const JndEstimate found = estimate(series, kDiffSeries);
    const auto profile = [&](double m) { return oracle::profile(series, kDiffSeries, m); };
    double best = -kInf, low = kInf, high = 0;
    for (double m = 0; m < 0.5; m += 0.0005) best = std::max(best, profile(m));
    CHECK(found.log_likelihood >= best - 1e-9);
    for (double m = 0; m < 0.5; m += 0.0005) {
      if (profile(m) < found.log_likelihood - kProfileDrop) continue;
      low = std::min(low, m);
      high = std::max(high, m);
    }
    CHECK(found.slope_ci_low <= low + 1e-9);
    CHECK(found.slope_ci_low >= low - 0.0005);
    CHECK(found.slope_ci_high >= high - 1e-9);
    CHECK(found.slope_ci_high <= high + 0.0005);
  }
}

// Uniform whatever the size of the case: small ones would be all zeros, which have no slope.
int uniform(int least, int most) {
  return *rc::gen::resize(rc::kNominalSize, rc::gen::inRange(least, most + 1));
}

std::vector<SeriesCounts> random_series() {
  std::vector<SeriesCounts> series;
  for (const double difference : {400.0, 300.0, 200.0}) {
    const int n_diff = uniform(1, 12), n_same = uniform(1, 12);
    series.push_back({difference, {n_diff, uniform(0, n_diff), n_same, uniform(0, n_same)}});
  }
  return series;
}

JndMethod random_method() {
  return kAll[static_cast<std::size_t>(uniform(0, 3))];
}

TEST_CASE("maximum likelihood agrees with a plain oracle on random counts", "[analysis][jnd]") {
  CHECK(rc::check("finite slopes, their likelihood, and their bounds", [] {
    const std::vector<SeriesCounts> series = random_series();
    const JndMethod method = random_method();
    const JndEstimate found = estimate(series, method);
    RC_PRE(std::isfinite(found.slope));
    // Golden sections see the value, not its derivative: the likelihood is compared closely, the slope through it.
    RC_ASSERT(std::abs(found.log_likelihood - oracle::profile(series, method, found.slope)) < 1e-8);
    const bool differencing = method == kDiffCommon || method == kDiffSeries;
    const double best = oracle::best_slope(series, method, differencing ? 0 : -0.1, 0.1);
    RC_ASSERT(oracle::profile(series, method, best) <= found.log_likelihood + 1e-8);
    RC_ASSERT(found.slope_ci_low <= found.slope);
    RC_ASSERT(found.slope_ci_high >= found.slope);
    for (const double bound : {found.slope_ci_low, found.slope_ci_high}) {
      if (differencing && bound == 0) continue;
      RC_ASSERT(std::abs(oracle::profile(series, method, bound) - (found.log_likelihood - kProfileDrop)) < 1e-7);
    }
  }));
}

// Equal numbers, both infinite alike, or both undefined.
bool alike(double a, double b, double tolerance) {
  if (std::isnan(a) || std::isnan(b)) return std::isnan(a) && std::isnan(b);
  return a == b || std::abs(a - b) <= tolerance * (1e-3 + std::abs(a));
}

TEST_CASE("a threshold does not depend on units, order, or how its counts are split", "[analysis][jnd]") {
  CHECK(rc::check("differences in another unit change the slope's unit only", [] {
    const std::vector<SeriesCounts> series = random_series();
    std::vector<SeriesCounts> in_n_per_mm = series;
    for (SeriesCounts& one : in_n_per_mm) one.difference /= 1000;
    const JndMethod method = random_method();
    const JndEstimate a = estimate(series, method), b = estimate(in_n_per_mm, method);
    RC_ASSERT(alike(1000 * a.slope, b.slope, 1e-8));
    RC_ASSERT(alike(1000 * a.slope_ci_low, b.slope_ci_low, 1e-8));
    RC_ASSERT(alike(1000 * a.slope_ci_high, b.slope_ci_high, 1e-8));
    RC_ASSERT(alike(a.log_likelihood, b.log_likelihood, 1e-10));
  }));
  CHECK(rc::check("nor on the order of the series", [] {
    const std::vector<SeriesCounts> series = random_series();
    const std::vector<SeriesCounts> reversed(series.rbegin(), series.rend());
    const JndMethod method = random_method();
    const JndEstimate a = estimate(series, method), b = estimate(reversed, method);
    RC_ASSERT(a.status == b.status);
    RC_ASSERT(alike(a.slope, b.slope, 1e-9));
    RC_ASSERT(alike(a.slope_ci_low, b.slope_ci_low, 1e-9));
    RC_ASSERT(alike(a.slope_ci_high, b.slope_ci_high, 1e-9));
  }));
  CHECK(rc::check("a series twice is a series with twice the counts", [] {
    const std::vector<SeriesCounts> series = random_series();
    std::vector<SeriesCounts> twice = series, doubled = series;
    twice.insert(twice.end(), series.begin(), series.end());
    for (SeriesCounts& one : doubled)
      one.counts = {2 * one.counts.n_diff, 2 * one.counts.hits, 2 * one.counts.n_same, 2 * one.counts.false_alarms};
    const JndMethod method = random_method();
    const JndEstimate once = estimate(series, method), a = estimate(twice, method), b = estimate(doubled, method);
    RC_ASSERT(alike(a.slope, once.slope, 1e-8));
    RC_ASSERT(alike(a.slope, b.slope, 1e-8));
    RC_ASSERT(alike(a.slope_ci_low, b.slope_ci_low, 1e-8));
    RC_ASSERT(alike(a.slope_ci_high, b.slope_ci_high, 1e-8));
    RC_ASSERT(alike(a.log_likelihood, 2 * once.log_likelihood, 1e-9));
  }));
  CHECK(rc::check("the two answers exchanged turn the slope of the yes-no model round", [] {
    const std::vector<SeriesCounts> series = random_series();
    std::vector<SeriesCounts> exchanged = series;
    for (SeriesCounts& one : exchanged) {
      one.counts.hits = one.counts.n_diff - one.counts.hits;
      one.counts.false_alarms = one.counts.n_same - one.counts.false_alarms;
    }
    const JndMethod method = uniform(0, 1) == 0 ? kYesNoCommon : kYesNoSeries;
    const JndEstimate a = estimate(series, method), b = estimate(exchanged, method);
    RC_ASSERT(alike(a.slope, -b.slope, 1e-8));
    RC_ASSERT(alike(a.slope_ci_low, -b.slope_ci_high, 1e-8));
    RC_ASSERT(alike(a.log_likelihood, b.log_likelihood, 1e-10));
  }));
  CHECK(rc::check("one hit more, or one false alarm less, never lowers the slope", [] {
    // With a criterion for each series. With a common one a hit at a small difference may speak against the slope.
    const std::vector<SeriesCounts> series = random_series();
    std::vector<SeriesCounts> better = series;
    SeriesCounts& one = better[static_cast<std::size_t>(uniform(0, 2))];
    const bool hit = uniform(0, 1) == 0;
    RC_PRE((hit ? one.counts.hits < one.counts.n_diff : one.counts.false_alarms > 0));
    if (hit)
      ++one.counts.hits;
    else
      --one.counts.false_alarms;
    const JndMethod method = uniform(0, 1) == 0 ? kYesNoSeries : kDiffSeries;
    const JndEstimate a = estimate(series, method), b = estimate(better, method);
    RC_PRE(a.status != JndStatus::no_information && b.status != JndStatus::no_information);
    RC_ASSERT(b.slope >= a.slope - 1e-10);
  }));
}

TEST_CASE("the slope behind expected counts is recovered", "[analysis][jnd]") {
  constexpr int kTrials = 100'000'000;
  for (const JndMethod method : kAll) {
    for (const double slope : {1 / 208.5, 1 / 351.0, 1 / 60.0}) {
      std::vector<SeriesCounts> series;
      for (const double difference : {400.0, 300.0, 200.0, 20.0}) {
        const double criterion = method == kYesNoCommon || method == kYesNoSeries ? -0.8 : 1.7;
        SeriesCounts one{difference, {kTrials, 0, kTrials, 0}};
        one.counts.hits =
            static_cast<int>(std::lround(kTrials * oracle::probability(method, criterion, slope * difference)));
        one.counts.false_alarms = static_cast<int>(std::lround(kTrials * oracle::probability(method, criterion, 0)));
        series.push_back(one);
      }
      const JndEstimate found = estimate(series, method);
      CHECK(found.slope == Approx(slope).epsilon(1e-6));
      CHECK(found.slope_ci_low < slope);
      CHECK(found.slope_ci_high > slope);
    }
  }
}

TEST_CASE("extreme counts and differences stay finite", "[analysis][jnd]") {
  const std::vector<std::vector<SeriesCounts>> all = {
      {{1, {1'000'000'000, 999'999'999, 1'000'000'000, 1}}, {1000, {1'000'000'000, 999'999'999, 10, 1}}},
      {{1e-6, {10, 6, 10, 4}}, {1e6, {10, 9, 10, 1}}},
      {{400, {1, 1, 1'000'000, 1}}, {1, {3, 2, 3, 1}}},
      {{400, {1'000'000, 999'999, 1'000'000, 999'998}}, {200, {5, 3, 5, 2}}},
  };
  for (const std::vector<SeriesCounts>& series : all) {
    for (const JndMethod method : kAll) {
      CAPTURE(to_string(method), series[0].difference, series[1].difference);
      const JndEstimate found = estimate(series, method);
      CHECK(std::isfinite(found.slope));
      CHECK(std::isfinite(found.log_likelihood));
      CHECK(std::isfinite(found.slope_ci_low));
      CHECK(std::isfinite(found.slope_ci_high));
      CHECK(found.slope_ci_low <= found.slope);
      CHECK(found.slope_ci_high >= found.slope);
    }
  }
}

TEST_CASE("logarithms of the normal distribution hold in both tails", "[analysis][jnd]") {
  // Laplace's continued fraction of the Mills ratio in 60 decimal digits.
  CHECK(log_normal_cdf(-10).log_cdf == Approx(-53.2312851505124).epsilon(1e-14));
  CHECK(log_normal_cdf(-40).log_cdf == Approx(-804.608442013754).epsilon(1e-14));
  CHECK(log_normal_cdf(8).log_cdf == Approx(-6.22096057427178e-16).epsilon(1e-12));
  // Continuous where the method changes, and the inverse Mills ratio is the derivative.
  for (const double z : {-25.0, -3.0, 0.0, 2.0}) {
    const double h = 1e-5;
    CHECK((log_normal_cdf(z + h).log_cdf - log_normal_cdf(z - h).log_cdf) / (2 * h) ==
          Approx(log_normal_cdf(z).inverse_mills).epsilon(1e-7));
    CHECK(log_normal_cdf(z - 1e-13).inverse_mills == Approx(log_normal_cdf(z + 1e-13).inverse_mills).epsilon(1e-11));
  }
}

TEST_CASE("the differencing model's terms are its logarithms and their derivatives", "[analysis][jnd]") {
  for (const double d : {0.0, 1e-9, 0.3, 2.0, 7.0}) {
    for (const double tau : {0.003, 0.05, 0.19, 0.21, 1.0, 3.0, 9.0}) {
      CAPTURE(d, tau);
      const DifferencingTerms at = differencing_terms(d, tau);
      CHECK(std::exp(at.log_different) + std::exp(at.log_same) == Approx(1).epsilon(1e-12));
      const double different = normal_cdf((d - tau) / std::sqrt(2.0)) + normal_cdf((-d - tau) / std::sqrt(2.0));
      CHECK(std::exp(at.log_different) == Approx(different).epsilon(1e-12));
      const double h = 1e-5 * tau;
      const DifferencingTerms more = differencing_terms(d, tau + h), less = differencing_terms(d, tau - h);
      CHECK((more.log_different - less.log_different) / (2 * h) == Approx(at.d_tau_different).epsilon(1e-6));
      CHECK((more.log_same - less.log_same) / (2 * h) == Approx(at.d_tau_same).epsilon(1e-6));
      CHECK((more.d_tau_different - less.d_tau_different) / (2 * h) ==
            Approx(at.d_tau2_different).epsilon(1e-5).margin(1e-9));
      CHECK((more.d_tau_same - less.d_tau_same) / (2 * h) == Approx(at.d_tau2_same).epsilon(1e-5).margin(1e-9));
      if (d < 0.1) continue;
      const DifferencingTerms further = differencing_terms(d + 1e-5, tau), nearer = differencing_terms(d - 1e-5, tau);
      CHECK((further.log_different - nearer.log_different) / 2e-5 ==
            Approx(at.d_d_different * d).epsilon(1e-5).margin(1e-9));
      CHECK((further.log_same - nearer.log_same) / 2e-5 == Approx(at.d_d_same * d).epsilon(1e-5).margin(1e-9));
    }
  }
}

}  // namespace
}  // namespace jnd
