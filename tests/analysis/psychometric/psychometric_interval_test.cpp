// Profile intervals against a maximum found by brute force, and the bootstrap against what it estimates.
#include "analysis/psychometric/psychometric_interval.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "analysis/numerics/special_values.h"
#include "tests/analysis/psychometric/psychometric_fixtures.h"
#include "tests/catch.h"

namespace jnd {
namespace {

using namespace jnd::testing;
constexpr double kDrop = 1.920729410347062;  // half the 95 % quantile of chi-square(1)

PsychometricModel model_of(PsychometricFunction function) {
  PsychometricModel model;
  model.function = function;
  return model;
}

// The maximum of a function of one variable with one peak, by golden sections.
double highest_by_sections(const std::function<double(double)>& value, double low, double high) {
  const double ratio = 0.6180339887498949;
  double a = high - ratio * (high - low), b = low + ratio * (high - low), at_a = value(a), at_b = value(b);
  for (int i = 0; i < 200; ++i) {
    if (at_a < at_b) {
      low = a;
      a = b;
      at_a = at_b;
      b = low + ratio * (high - low);
      at_b = value(b);
    } else {
      high = b;
      b = a;
      at_b = at_a;
      a = high - ratio * (high - low);
      at_a = value(a);
    }
  }
  return std::max(at_a, at_b);
}

void check_drop(double profile, const PsychometricFit& fit) {
  CHECK(fit.log_likelihood - profile == Approx(kDrop).epsilon(1e-6));
}

TEST_CASE("at each bound of a profile interval the likelihood, maximised anew, is down by 1.92", "[psychometric]") {
  // Two parameters: for a given value of one quantity the rest is one variable, here the second parameter.
  for (const PsychometricFunction function : kFunctions) {
    CAPTURE(to_string(function));
    const PsychometricFit fit = fit_psychometric(kComparison, model_of(function));
    const PsychometricIntervals intervals = psychometric_profile(kComparison, model_of(function));
    const double b = fit.second.value;
    const auto likelihood = [&](double location, double second) {
      return plain_log_likelihood(kComparison, function, location, second, 0, 0);
    };
    // Location at which a function with this second parameter has the quantity.
    const auto unit = [&](double second, double p) { return plain_quantile(function, 1, second, p); };
    const auto for_pse = [&](double pse, double second) {
      return function == PsychometricFunction::weibull ? pse / unit(second, 0.5) : pse - (unit(second, 0.5) - 1);
    };
    for (const double pse : {intervals.pse.low, intervals.pse.high})
      check_drop(
          highest_by_sections([&](double second) { return likelihood(for_pse(pse, second), second); }, b / 4, 4 * b),
          fit);
    for (const double location : {intervals.location.low, intervals.location.high})
      check_drop(highest_by_sections([&](double second) { return likelihood(location, second); }, b / 4, 4 * b), fit);
    for (const double second : {intervals.second.low, intervals.second.high})
      check_drop(highest_by_sections([&](double location) { return likelihood(location, second); }, 700, 1100), fit);
    for (const double jnd : {intervals.jnd.low, intervals.jnd.high}) {
      if (function == PsychometricFunction::weibull) {
        check_drop(
            highest_by_sections(
                [&](double second) { return likelihood(jnd / (unit(second, 0.75) - unit(second, 0.5)), second); },
                b / 4, 4 * b),
            fit);
      } else {
        // Location drops out: JND fixes the second parameter, in proportion or inversely.
        const double ratio = jnd / fit.jnd.value;
        const double second = function == PsychometricFunction::gaussian ? b * ratio : b / ratio;
        check_drop(highest_by_sections([&](double location) { return likelihood(location, second); }, 700, 1100), fit);
      }
    }
    for (const double slope : {intervals.slope.low, intervals.slope.high})
      if (function == PsychometricFunction::weibull) {
        // dF/dx at the PSE = shape ln 2 / (2 PSE).
        check_drop(
            highest_by_sections(
                [&](double second) { return likelihood(for_pse(second * std::log(2.0) / 2 / slope, second), second); },
                b / 2, 2 * b),
            fit);
      } else {
        CHECK((slope == Approx(fit.slope.value * fit.jnd.value / intervals.jnd.low).epsilon(1e-7) ||
               slope == Approx(fit.slope.value * fit.jnd.value / intervals.jnd.high).epsilon(1e-7)));
      }
  }
}

TEST_CASE("the interval of a free lapse is where the likelihood with the lapse fixed is down by 1.92",
          "[psychometric]") {
  PsychometricModel model = model_of(PsychometricFunction::logistic);
  model.guess = 0.5;
  model.lapse.reset();
  const PsychometricFit fit = fit_psychometric(kForcedChoice, model);
  const PsychometricIntervals intervals = psychometric_profile(kForcedChoice, model);
  PsychometricModel fixed = model;
  fixed.lapse = intervals.lapse.low;
  check_drop(fit_psychometric(kForcedChoice, fixed).log_likelihood, fit);
  CHECK(intervals.lapse.high == kLargestLapse);  // the likelihood never falls that far before
  fixed.lapse = kLargestLapse;
  CHECK(fit_psychometric(kForcedChoice, fixed).log_likelihood > fit.log_likelihood - kDrop);
  CHECK(std::isnan(intervals.guess.low));
}

TEST_CASE("intervals hold their estimate, shrink with trials and widen with confidence", "[psychometric]") {
  std::mt19937_64 generator(11);
  for (const PsychometricFunction function : kFunctions)
    for (const bool free_lapse : {false, true})
      for (int run = 0; run < 5; ++run) {
        PsychometricModel model = model_of(function);
        if (free_lapse) model.lapse.reset();
        const auto levels = simulated(function, truth_of(function), 0, 0.02, 40, generator);
        const PsychometricFit fit = fit_psychometric(levels, model);
        REQUIRE(is_estimate(fit.status));
        const PsychometricIntervals wide = psychometric_profile(levels, model, 0.99),
                                    usual = psychometric_profile(levels, model);
        const auto holds = [](const ConfidenceBounds& outer, const ConfidenceBounds& inner, double value) {
          CAPTURE(outer.low, inner.low, value, inner.high, outer.high);
          CHECK((outer.low <= inner.low && inner.low <= value && value <= inner.high && inner.high <= outer.high));
        };
        holds(wide.pse, usual.pse, fit.pse.value);
        holds(wide.jnd, usual.jnd, fit.jnd.value);
        holds(wide.slope, usual.slope, fit.slope.value);
        holds(wide.location, usual.location, fit.location.value);
        holds(wide.second, usual.second, fit.second.value);
        if (free_lapse) holds(wide.lapse, usual.lapse, fit.lapse.value);
      }
  std::vector<PsychometricLevel> hundredfold = kComparison;
  for (PsychometricLevel& level : hundredfold) level = {level.x, 100 * level.n, 100 * level.k};
  const PsychometricModel model;
  const ConfidenceBounds few = psychometric_profile(kComparison, model).pse,
                         many = psychometric_profile(hundredfold, model).pse;
  CHECK((few.high - few.low) / (many.high - many.low) == Approx(10).epsilon(0.04));
  // And with many trials it is the Wald interval.
  const PsychometricFit fit = fit_psychometric(hundredfold, model);
  CHECK((many.high - many.low) / (2 * 1.959963984540054 * fit.pse.se) == Approx(1).epsilon(0.001));
}

TEST_CASE("where data bound a quantity on one side only, the interval says so", "[psychometric]") {
  const PsychometricModel model;
  const PsychometricIntervals steep =
      psychometric_profile(std::vector<PsychometricLevel>{{1, 10, 0}, {2, 10, 0}, {3, 10, 4}, {4, 10, 10}}, model);
  CHECK(steep.jnd.low == 0);
  CHECK((steep.jnd.high > 0.1 && steep.jnd.high < 2));
  CHECK(steep.slope.high == kInf);
  CHECK((steep.pse.low < 3 && steep.pse.high > 3 && steep.pse.low > 2 && steep.pse.high < 4));
  const PsychometricIntervals flat =
      psychometric_profile(std::vector<PsychometricLevel>{{1, 10, 6}, {2, 10, 5}, {3, 10, 5}}, model);
  CHECK(flat.jnd.high == kInf);
  CHECK(flat.slope.low == 0);
  CHECK((flat.slope.high > 0 && std::isfinite(flat.slope.high)));
  CHECK(std::isnan(flat.pse.low));
  const PsychometricIntervals weak =
      psychometric_profile(std::vector<PsychometricLevel>{{1, 10, 4}, {2, 10, 5}, {3, 10, 6}}, model);
  CHECK(weak.pse.low == -kInf);
  CHECK(weak.pse.high == kInf);
  const PsychometricIntervals none = psychometric_profile(std::vector<PsychometricLevel>{{1, 10, 0}}, model);
  CHECK((std::isnan(none.jnd.low) && std::isnan(none.slope.high)));
}

TEST_CASE("the bootstrap repeats itself by its seed and agrees with the profile where trials are many",
          "[psychometric]") {
  std::vector<PsychometricLevel> many = kComparison;
  for (PsychometricLevel& level : many) level = {level.x, 30 * level.n, 30 * level.k};
  const PsychometricModel model;
  const PsychometricBootstrap one = psychometric_bootstrap(many, model, 1000, 5),
                              same = psychometric_bootstrap(many, model, 1000, 5),
                              other = psychometric_bootstrap(many, model, 1000, 6);
  CHECK(one.intervals.jnd.low == same.intervals.jnd.low);
  CHECK(one.deviance_p == same.deviance_p);
  CHECK(one.intervals.jnd.low != other.intervals.jnd.low);
  CHECK(one.estimates == 1000);
  const PsychometricIntervals profile = psychometric_profile(many, model);
  const double width = profile.pse.high - profile.pse.low;
  CHECK(std::abs(one.intervals.pse.low - profile.pse.low) < 0.08 * width);
  CHECK(std::abs(one.intervals.pse.high - profile.pse.high) < 0.08 * width);
}

TEST_CASE("the bootstrap p of the deviance is near the asymptotic one, and small for a bad fit", "[psychometric]") {
  const PsychometricModel model;
  std::vector<PsychometricLevel> good = kComparison, bad = kComparison;
  for (PsychometricLevel& level : good) level = {level.x, 10 * level.n, 10 * level.k};
  const PsychometricFit fit = fit_psychometric(good, model);
  const double p = psychometric_bootstrap(good, model, 1000, 3).deviance_p;
  CHECK(std::abs(p - fit.deviance_p) < 0.06);  // four standard errors of 1000 replicates
  for (std::size_t i = 0; i < bad.size(); ++i) bad[i].k = i % 2 == 0 ? bad[i].k / 2 : std::min(20, bad[i].k + 6);
  CHECK(fit_psychometric(bad, model).deviance_p < 1e-4);
  std::vector<PsychometricLevel> single;
  for (int i = 0; i < 40; ++i) single.push_back({i + 0.5, 1, i % 4 < i / 10 ? 1 : 0});
  const PsychometricFit few = fit_psychometric(single, model);
  CHECK(few.few_trials);
  CHECK((few.deviance > 0 && std::isnan(few.deviance_p)));
  CHECK(psychometric_bootstrap(bad, model, 500, 3).deviance_p == Approx(1.0 / 501));
}

TEST_CASE("the bootstrap says after each replicate how many are done", "[psychometric]") {
  // Few trials: some replicates have one and the same answer throughout.
  std::vector<int> said, expected;
  const PsychometricBootstrap few =
      psychometric_bootstrap(std::vector<PsychometricLevel>{{1, 2, 0}, {2, 2, 1}, {3, 2, 0}, {4, 2, 1}}, {}, 100, 1,
                             0.95, [&said](int done) { said.push_back(done); });
  for (int i = 1; i <= 100; ++i) expected.push_back(i);
  CHECK(few.others > 0);
  CHECK(said == expected);
}

TEST_CASE("bootstrap fits without a threshold count as what they say", "[psychometric]") {
  const PsychometricModel model;
  const PsychometricBootstrap few =
      psychometric_bootstrap(std::vector<PsychometricLevel>{{1, 10, 4}, {2, 10, 5}, {3, 10, 6}}, model, 500, 1);
  CHECK(few.not_increasing > 50);
  CHECK(few.intervals.jnd.high == kInf);
  CHECK(few.intervals.slope.low == 0);
  CHECK(few.estimates + few.separated + few.not_increasing + few.others == 500);
  CHECK(few.with_pse <= few.estimates + few.separated);
  const PsychometricBootstrap none =
      psychometric_bootstrap(std::vector<PsychometricLevel>{{1, 10, 0}, {2, 10, 10}}, model, 100, 1);
  CHECK(std::isnan(none.deviance_p));
  CHECK(std::isnan(none.intervals.jnd.high));
}

}  // namespace
}  // namespace jnd
