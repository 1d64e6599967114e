// Fits of psychometric functions and their comparisons.
#include "analysis/psychometric/psychometric.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>

#include <nlohmann/json.hpp>

#include "analysis/numerics/special_values.h"
#include "analysis/psychometric/psychometric_compare.h"
#include "analysis/psychometric/psychometric_joint.h"
#include "analysis/selftest/reference_numbers.h"
#include "tests/analysis/psychometric/psychometric_fixtures.h"
#include "tests/catch.h"

namespace jnd {
namespace {

// Fits of psychometric functions against R 4.2.2, against the likelihood written down directly, and what statuses mean.

using namespace jnd::testing;
using nlohmann::json;

void check_relative(double ours, const json& theirs, double tolerance) {
  const double reference = theirs.get<double>();
  CAPTURE(ours, reference);
  CHECK(std::abs(ours - reference) <= tolerance * std::abs(reference));
}

PsychometricFit fit_of(const std::vector<PsychometricLevel>& levels,
                       PsychometricFunction function = PsychometricFunction::logistic, double guess = 0) {
  PsychometricModel model;
  model.function = function;
  model.guess = guess;
  return fit_psychometric(levels, model);
}

TEST_CASE("every reference fit agrees with R in parameters, errors, likelihood, deviance and thresholds",
          "[psychometric]") {
  const json& reference = reference_numbers("psychometric");
  int fits = 0;
  for (const json& data : reference.at("cases")) {
    std::vector<PsychometricLevel> levels;
    for (std::size_t i = 0; i < data.at("x").size(); ++i)
      levels.push_back({data["x"][i].get<double>(), data["n"][i].get<int>(), data["k"][i].get<int>()});
    PsychometricModel model;
    model.guess = data.at("guess").get<double>();
    model.lapse.reset();
    if (!data.at("lapse_fixed").is_null()) model.lapse = data["lapse_fixed"].get<double>();
    for (const std::string kind : {"fits", "map_fits"}) {
      if (!data.contains(kind)) continue;
      if (kind == "map_fits") {
        model.estimator = PsychometricEstimator::map;
        model.prior = {2, 50};
      }
      for (const json& expected : data[kind]) {
        CAPTURE(data.at("id").get<std::string>(), kind, expected.at("family").get<std::string>());
        ++fits;
        model.function = psychometric_function_from(expected["family"].get<std::string>()).value();
        const PsychometricFit fit = fit_psychometric(levels, model);
        REQUIRE(fit.status == PsychometricStatus::ok);
        const json &par = expected.at("par"), &se = expected.at("se_observed_info");
        check_relative(fit.location.value, par[0], 1e-8);
        check_relative(fit.second.value, par[1], 1e-8);
        check_relative(fit.location.se, se[0], 1e-7);
        check_relative(fit.second.se, se[1], 1e-7);
        if (!model.lapse) {
          check_relative(fit.lapse.value, par[2], 1e-8);
          check_relative(fit.lapse.se, se[2], 1e-7);
        }
        CHECK(std::abs(fit.log_likelihood - expected.at("logLik_no_binomial_const").get<double>()) <= 1e-8);
        CHECK(std::abs(fit.deviance - expected.at("deviance").get<double>()) <= 1e-8);
        check_relative(fit.pse.value, expected.at("F50"), 1e-8);
        check_relative(fit.jnd.value, expected.at("JND_F75_minus_F50"), 1e-8);
        const double low = plain_quantile(model.function, fit.location.value, fit.second.value, 0.25);
        const double high = plain_quantile(model.function, fit.location.value, fit.second.value, 0.75);
        check_relative(low, expected.at("F25"), 1e-8);
        check_relative(high, expected.at("F75"), 1e-8);
        check_relative((high - low) / 2, expected.at("JND_half_F75_minus_F25"), 1e-8);
        const double at75 = (0.75 - fit.guess.value) / (1 - fit.guess.value - fit.lapse.value);
        check_relative(plain_quantile(model.function, fit.location.value, fit.second.value, at75),
                       expected.at("x_at_psi75"), 1e-8);
      }
    }
    if (data.contains("glm_logit")) {
      // The logit link is canonical: observed and expected information agree, and so do the errors with glm's.
      const PsychometricFit fit = fit_of(levels);
      check_relative(fit.pse.se, data["glm_logit"].at("PSE_se_delta"), 1e-8);
      check_relative(fit.second.se, data["glm_logit"].at("slope_se"), 1e-8);
    }
  }
  CHECK(fits == 6);
}

TEST_CASE("errors of PSE, JND and slope follow from those of the parameters where these are proportional",
          "[psychometric]") {
  const PsychometricFit fit = fit_of(kComparison);
  CHECK(fit.slope.value == Approx(fit.second.value / 4).epsilon(1e-12));
  CHECK(fit.slope.se == Approx(fit.second.se / 4).epsilon(1e-12));
  CHECK(fit.jnd.se / fit.jnd.value == Approx(fit.second.se / fit.second.value).epsilon(1e-12));
  CHECK(fit.pse.se == Approx(fit.location.se).epsilon(1e-12));
}

TEST_CASE("PSE, JND and slope are what their definitions say, for every function", "[psychometric]") {
  for (const PsychometricFunction function : kFunctions) {
    const PsychometricFit fit = fit_of(kComparison, function);
    REQUIRE(fit.status == PsychometricStatus::ok);
    const double a = fit.location.value, b = fit.second.value, x = fit.pse.value, h = 1e-4 * x;
    CHECK(plain_cdf(function, a, b, x) == Approx(0.5).epsilon(1e-12));
    CHECK(plain_cdf(function, a, b, x + fit.jnd.value) == Approx(0.75).epsilon(1e-12));
    const double slope = (plain_cdf(function, a, b, x + h) - plain_cdf(function, a, b, x - h)) / (2 * h);
    CHECK(fit.slope.value == Approx(slope).epsilon(1e-6));
    CHECK(fit.log_likelihood == Approx(plain_log_likelihood(kComparison, fit)).epsilon(1e-12));
    CHECK(fit.degrees_of_freedom == 7);
    CHECK(fit.trials == 180);
    CHECK((fit.deviance_p > 0 && fit.deviance_p < 1));
  }
}

TEST_CASE("data without a threshold say so, and leave undefined what is undefined", "[psychometric]") {
  for (const PsychometricFunction function : kFunctions) {
    CAPTURE(to_string(function));
    for (const std::vector<PsychometricLevel>& levels :
         {std::vector<PsychometricLevel>{{1, 10, 0}, {2, 10, 0}, {3, 10, 0}},
          std::vector<PsychometricLevel>{{1, 10, 10}, {2, 10, 10}, {3, 10, 10}}, std::vector<PsychometricLevel>{},
          std::vector<PsychometricLevel>{{1, 0, 0}, {2, 0, 0}}}) {
      const PsychometricFit fit = fit_of(levels, function);
      CHECK(fit.status == PsychometricStatus::no_information);
      CHECK((std::isnan(fit.pse.value) && std::isnan(fit.jnd.value) && std::isnan(fit.location.value)));
      CHECK(std::isnan(fit.log_likelihood));
    }
    CHECK(fit_of({{2, 10, 4}}, function).status == PsychometricStatus::not_identified);
    CHECK(fit_of({{2, 10, 4}, {2, 10, 7}}, function).status == PsychometricStatus::not_identified);
    for (const std::vector<PsychometricLevel>& levels :
         {std::vector<PsychometricLevel>{{1, 10, 8}, {2, 10, 6}, {3, 10, 3}},
          std::vector<PsychometricLevel>{{1, 10, 5}, {2, 10, 5}, {3, 10, 5}}}) {
      const PsychometricFit fit = fit_of(levels, function);
      CHECK(fit.status == PsychometricStatus::not_increasing);
      CHECK((std::isnan(fit.pse.value) && std::isnan(fit.jnd.value) && std::isnan(fit.slope.value)));
      int n = 0, k = 0;
      for (const PsychometricLevel& level : levels) n += level.n, k += level.k;
      const double p = static_cast<double>(k) / n;
      CHECK(fit.log_likelihood == Approx(k * std::log(p) + (n - k) * std::log(1 - p)).epsilon(1e-12));
    }
  }
}

TEST_CASE("perfectly separated answers have an infinite slope", "[psychometric]") {
  for (const PsychometricFunction function : kFunctions) {
    CAPTURE(to_string(function));
    const PsychometricFit between = fit_of({{1, 10, 0}, {2, 10, 0}, {3, 10, 10}, {4, 10, 10}}, function);
    CHECK(between.status == PsychometricStatus::separated);
    CHECK(std::isnan(between.pse.value));
    CHECK(between.jnd.value == 0);
    CHECK(between.slope.value == kInf);
    CHECK(between.log_likelihood == 0);
    const PsychometricFit through = fit_of({{1, 10, 0}, {2, 10, 0}, {3, 10, 4}, {4, 10, 10}}, function);
    CHECK(through.status == PsychometricStatus::separated);
    CHECK(through.pse.value == 3);
    CHECK(through.deviance == Approx(0).margin(1e-12));
  }
  // With a guess rate the step may be the best without fitting every rate: 0.4 at chance.
  const PsychometricFit chance =
      fit_of({{1, 10, 4}, {2, 10, 5}, {3, 10, 10}, {4, 10, 10}}, PsychometricFunction::weibull, 0.5);
  CHECK(chance.status == PsychometricStatus::separated);
  CHECK(chance.log_likelihood == Approx(20 * std::log(0.5)).epsilon(1e-12));
}

TEST_CASE("a free lapse at its bound is named, and the rest is the fit with the lapse fixed there", "[psychometric]") {
  PsychometricModel free, fixed;
  free.lapse.reset();
  const PsychometricFit found = fit_psychometric(kComparison, free), known = fit_psychometric(kComparison, fixed);
  CHECK(found.status == PsychometricStatus::lapse_at_bound);
  CHECK(found.lapse.value == 0);
  CHECK(std::isnan(found.lapse.se));
  CHECK(found.location.value == Approx(known.location.value).epsilon(1e-10));
  CHECK(found.second.se == Approx(known.second.se).epsilon(1e-9));
  CHECK(found.degrees_of_freedom == known.degrees_of_freedom - 1);

  std::vector<PsychometricLevel> lazy = kComparison;  // a quarter missed at the top
  for (PsychometricLevel& level : lazy) level.k = level.x > 900 ? 15 : level.k;
  const PsychometricFit most = fit_psychometric(lazy, free);
  CHECK(most.status == PsychometricStatus::lapse_at_bound);
  CHECK(most.lapse.value == kLargestLapse);

  free.lapse = 0.0;
  free.guess.reset();
  std::vector<PsychometricLevel> mirrored = kComparison;
  for (PsychometricLevel& level : mirrored) level = {-level.x, level.n, level.n - level.k};
  const PsychometricFit guess = fit_psychometric(mirrored, free);
  CHECK(guess.status == PsychometricStatus::guess_at_bound);
  CHECK(std::isnan(guess.guess.se));
}

TEST_CASE("the prior of map keeps the lapse inside, and counts only through the mode", "[psychometric]") {
  PsychometricModel map;
  map.lapse.reset();
  map.estimator = PsychometricEstimator::map;
  for (const PsychometricFunction function : kFunctions) {
    map.function = function;
    const PsychometricFit fit = fit_psychometric(kComparison, map);
    CHECK(fit.status == PsychometricStatus::ok);
    CHECK((fit.lapse.value > 0 && fit.lapse.value < kLargestLapse));
    CHECK(fit.log_likelihood == Approx(plain_log_likelihood(kComparison, fit)).epsilon(1e-12));
    // At the mode: d logL / d lapse = -(0.2 / lapse - 9 / (1 - lapse)), the first by central differences.
    const double h = 1e-6, lapse = fit.lapse.value;
    const auto at = [&](double rate) {
      return plain_log_likelihood(kComparison, function, fit.location.value, fit.second.value, 0, rate);
    };
    CHECK((at(lapse + h) - at(lapse - h)) / (2 * h) == Approx(9 / (1 - lapse) - 0.2 / lapse).epsilon(1e-5));
  }
}

TEST_CASE("levels from 1e-9 to 1e9 and a million trials a level are fitted", "[psychometric]") {
  std::vector<PsychometricLevel> wide;
  for (int i = -9; i <= 9; i += 3) wide.push_back({std::pow(10.0, i), 100, 50 + 5 * i});
  const PsychometricFit fit = fit_of(wide, PsychometricFunction::weibull);
  REQUIRE(fit.status == PsychometricStatus::ok);
  CHECK(fit.log_likelihood == Approx(plain_log_likelihood(wide, fit)).epsilon(1e-12));
  CHECK((fit.pse.value > 1e-4 && fit.pse.value < 1e4));
  for (const PsychometricFunction function : kFunctions) {
    CHECK_FALSE(fit_of(wide, function).status == PsychometricStatus::no_information);
    std::vector<PsychometricLevel> many;
    const Truth truth = truth_of(function);
    for (int x = 1; x <= 8; ++x)
      many.push_back({static_cast<double>(x), 1'000'000,
                      static_cast<int>(std::lround(1e6 * plain_cdf(function, truth.location, truth.second, x)))});
    const PsychometricFit exact = fit_of(many, function);
    REQUIRE(exact.status == PsychometricStatus::ok);
    CHECK(exact.location.value == Approx(truth.location).epsilon(1e-5));
    CHECK(exact.second.value == Approx(truth.second).epsilon(1e-5));
    CHECK(exact.deviance < 0.5);  // of rounding the counts
  }
}

TEST_CASE("what cannot be counts or a model is refused", "[psychometric]") {
  const PsychometricModel model;
  CHECK_THROWS_AS(fit_psychometric(std::vector<PsychometricLevel>{{1, 10, 11}}, model), std::invalid_argument);
  CHECK_THROWS_AS(fit_psychometric(std::vector<PsychometricLevel>{{1, -1, 0}}, model), std::invalid_argument);
  CHECK_THROWS_AS(fit_psychometric(std::vector<PsychometricLevel>{{kInf, 10, 1}}, model), std::invalid_argument);
  CHECK_THROWS_AS(fit_of({{0, 10, 1}, {1, 10, 4}}, PsychometricFunction::weibull), std::invalid_argument);
  CHECK_THROWS_AS(fit_of(kComparison, PsychometricFunction::logistic, 1), std::invalid_argument);
  const int most = std::numeric_limits<int>::max();
  CHECK_THROWS_AS(fit_of({{1, most, 5}, {1, most, 5}, {2, 10, 9}}), std::invalid_argument);
  PsychometricModel wrong;
  wrong.lapse.reset();
  wrong.prior.a = 0.5;
  CHECK_THROWS_AS(fit_psychometric(kComparison, wrong), std::invalid_argument);
}

// Nested comparisons of groups against maxima found by brute force on the likelihood written down directly.

using Groups = std::vector<std::vector<PsychometricLevel>>;

Groups three_groups() {
  Groups groups(3, kComparison);
  const int second[] = {0, 4, 9, 12, 14, 15, 18, 20, 20}, third[] = {3, 5, 7, 8, 11, 13, 13, 16, 18};
  for (std::size_t i = 0; i < kComparison.size(); ++i) {
    groups[1][i].k = second[i];
    groups[2][i].k = third[i];
  }
  return groups;
}

// Largest value of a function with one peak, by repeatedly refining a grid.
double highest(const std::function<double(double)>& value, double low, double high) {
  double best = -1e300, at = low;
  for (int round = 0; round < 12; ++round) {
    constexpr int kParts = 20;
    for (int i = 0; i <= kParts; ++i) {
      const double x = low + (high - low) * i / kParts;
      if (const double found = value(x); found > best) {
        best = found;
        at = x;
      }
    }
    const double step = (high - low) / kParts;
    low = at - 2 * step;
    high = at + 2 * step;
  }
  return best;
}

TEST_CASE("each model of several groups reaches the maximum that brute force finds", "[psychometric]") {
  const Groups groups = three_groups();
  PsychometricModel model;
  const PsychometricComparison found = compare_psychometric(groups, model);
  const auto likelihood = [&](std::size_t group, double alpha, double beta) {
    return plain_log_likelihood(groups[group], PsychometricFunction::logistic, alpha, beta, 0, 0);
  };
  double own = 0;
  std::vector<PsychometricLevel> all;
  for (const auto& levels : groups) {
    own += fit_psychometric(levels, model).log_likelihood;
    all.insert(all.end(), levels.begin(), levels.end());
  }
  const auto sum = [&](const std::function<double(std::size_t)>& of) { return of(0) + of(1) + of(2); };
  const double own_location = highest(
      [&](double beta) {
        return sum([&](std::size_t g) {
          return highest([&](double alpha) { return likelihood(g, alpha, beta); }, 700, 1100);
        });
      },
      0.004, 0.03);
  const double own_slope = highest(
      [&](double alpha) {
        return sum([&](std::size_t g) {
          return highest([&](double beta) { return likelihood(g, alpha, beta); }, 0.001, 0.05);
        });
      },
      700, 1100);
  CHECK(found.groups == 3);
  CHECK(found.fits[0].log_likelihood == Approx(fit_psychometric(all, model).log_likelihood).epsilon(1e-12));
  CHECK(found.fits[1].log_likelihood == Approx(own_location).epsilon(1e-9));
  CHECK(found.fits[2].log_likelihood == Approx(own_slope).epsilon(1e-9));
  CHECK(found.fits[3].log_likelihood == Approx(own).epsilon(1e-12));
  const int parameters[] = {2, 4, 4, 6}, df[] = {2, 2, 4, 2, 2};
  for (std::size_t i = 0; i < 4; ++i) {
    CHECK(found.fits[i].status == PsychometricStatus::ok);
    CHECK(found.fits[i].parameters == parameters[i]);
  }
  for (std::size_t i = 0; i < 5; ++i) {
    const SharingTest& test = found.tests[i];
    const auto fit = [&](PsychometricSharing sharing) { return found.fits[static_cast<std::size_t>(sharing)]; };
    CHECK(test.df == df[i]);
    CHECK(test.chi_square ==
          Approx(2 * (fit(test.general).log_likelihood - fit(test.simpler).log_likelihood)).epsilon(1e-12));
    // Upper tail of chi-square with 2 and 4 degrees of freedom in closed form.
    const double half = test.chi_square / 2;
    CHECK(test.p == Approx(std::exp(-half) * (test.df == 4 ? 1 + half : 1)).epsilon(1e-10));
  }
}

TEST_CASE("a free lapse is common to the groups: the joint maximum is that of the best lapse", "[psychometric]") {
  const Groups groups(2, kForcedChoice);
  Groups different = groups;
  for (PsychometricLevel& level : different[1]) level.k = std::max(0, level.k - (level.x < 150 ? 6 : 1));
  for (const PsychometricFunction function : kFunctions) {
    CAPTURE(to_string(function));
    PsychometricModel model;
    model.function = function;
    model.guess = 0.5;
    model.lapse.reset();
    const PsychometricComparison found = compare_psychometric(different, model);
    for (const std::size_t i : {1U, 2U, 3U}) {
      const auto with_lapse = [&](double lapse) {
        PsychometricModel fixed = model;
        fixed.lapse = std::clamp(lapse, 0.0, kLargestLapse);
        return compare_psychometric(different, fixed).fits[i].log_likelihood;
      };
      REQUIRE(is_estimate(found.fits[i].status));
      const double best = found.fits[i].lapse;
      CHECK(found.fits[i].log_likelihood == Approx(with_lapse(best)).epsilon(1e-10));
      CHECK(found.fits[i].log_likelihood >= with_lapse(best + 0.003) - 1e-10);
      CHECK(found.fits[i].log_likelihood >= with_lapse(best - 0.003) - 1e-10);
    }
    CHECK(found.fits[0].log_likelihood <= found.fits[1].log_likelihood);
    CHECK(found.fits[0].log_likelihood <= found.fits[2].log_likelihood);
    CHECK(found.fits[1].log_likelihood <= found.fits[3].log_likelihood);
    CHECK(found.fits[2].log_likelihood <= found.fits[3].log_likelihood);
    const PsychometricComparison equal = compare_psychometric(groups, model);
    for (const SharingTest& test : equal.tests) {
      CHECK(test.status == PsychometricStatus::ok);
      CHECK(test.chi_square == Approx(0).margin(1e-8));
      CHECK(test.p > 0.999);
    }
  }
}

TEST_CASE("no model is more likely than one that contains it", "[psychometric]") {
  int compared = 0;
  // The last three are data on which searches from the pooled function and from the groups' own alone ended lower.
  for (const std::uint64_t seed : {1, 2, 3, 268, 664, 726}) {
    std::mt19937_64 g(seed);
    PsychometricModel model;
    model.function = kFunctions[g() % 4];
    model.guess.reset();
    model.lapse.reset();
    if (g() % 3 == 0)
      model.guess = 0.0;
    else if (g() % 3 == 0)
      model.lapse = 0.02;
    Groups groups;
    const std::uint64_t count = 2 + g() % 2;
    for (std::uint64_t group = 0; group < count; ++group) {
      Truth truth = truth_of(model.function);
      truth.location *= 0.8 + static_cast<double>(g() % 100) / 200;
      truth.second *= 0.5 + static_cast<double>(g() % 100) / 60;
      const int trials = 3 + static_cast<int>(g() % 20);
      const int levels = 5 + static_cast<int>(g() % 8);
      groups.push_back(simulated(model.function, truth, model.guess.value_or(0.1), 0.06, trials, g, levels));
    }
    const auto& [same, location, slope, both] = compare_psychometric(groups, model).fits;
    using Pair = std::pair<const SharingFit&, const SharingFit&>;
    for (const auto& [simpler, general] :
         {Pair(same, location), Pair(same, slope), Pair(same, both), Pair(location, both), Pair(slope, both)}) {
      if (!is_estimate(simpler.status) || !is_estimate(general.status)) continue;
      ++compared;
      CAPTURE(seed, to_string(simpler.sharing), to_string(general.sharing));
      CHECK(general.log_likelihood >= simpler.log_likelihood - 1e-9);
    }
  }
  CHECK(compared >= 15);  // of 6 times 5
}

TEST_CASE("the joint likelihood's derivatives agree with finite differences", "[psychometric]") {
  const Groups groups = three_groups();
  PsychometricModel model;
  model.lapse.reset();
  model.guess.reset();
  std::vector<PsychometricLevel> all;
  for (const auto& levels : groups) all.insert(all.end(), levels.begin(), levels.end());
  for (const PsychometricSharing sharing :
       {PsychometricSharing::own_location, PsychometricSharing::own_slope, PsychometricSharing::own_function}) {
    const JointLikelihood likelihood(groups, model, sharing, psychometric_data(all, model));
    std::vector<double> place = {0.03, 0.1, 0, 0, 0, 0, 0, 0};
    place.resize(likelihood.variables());
    for (std::size_t g = 0; g < groups.size(); ++g) {
      place[likelihood.location_index(g)] = 0.1 + 0.05 * static_cast<double>(g);
      place[likelihood.slope_index(g)] = 6 + static_cast<double>(g);
    }
    const std::size_t n = place.size();
    NewtonDerivatives at, up, down;
    likelihood.derivatives(place, at);
    for (std::size_t i = 0; i < n; ++i) {
      const double h = 1e-5;
      std::vector<double> more = place, less = place;
      more[i] += h;
      less[i] -= h;
      CAPTURE(to_string(sharing), i);
      CHECK(at.gradient[i] ==
            Approx((likelihood.value(more) - likelihood.value(less)) / (2 * h)).epsilon(1e-5).margin(1e-4));
      likelihood.derivatives(more, up);
      likelihood.derivatives(less, down);
      for (std::size_t j = 0; j < n; ++j)
        CHECK(at.curvature[i * n + j] ==
              Approx(-(up.gradient[j] - down.gradient[j]) / (2 * h)).epsilon(1e-5).margin(1e-3));
    }
  }
}

TEST_CASE("a comparison with a group that has no function of its own is refused with the reason", "[psychometric]") {
  const PsychometricModel model;
  Groups groups = {kComparison, kComparison};
  for (PsychometricLevel& level : groups[1]) level.k = 0;
  PsychometricComparison found = compare_psychometric(groups, model);
  CHECK(found.fits[0].status == PsychometricStatus::ok);
  for (const SharingTest& test : found.tests) {
    CHECK(test.status == PsychometricStatus::no_information);
    CHECK((std::isnan(test.chi_square) && std::isnan(test.p)));
  }
  for (PsychometricLevel& level : groups[1]) level.k = level.x < 900 ? 0 : level.n;
  found = compare_psychometric(groups, model);
  CHECK(found.fits[1].status == PsychometricStatus::ok);  // a common slope is finite
  CHECK(found.fits[3].status == PsychometricStatus::separated);
  CHECK(found.tests[0].status == PsychometricStatus::ok);
  CHECK(found.tests[3].status == PsychometricStatus::separated);
  for (PsychometricLevel& level : groups[1]) level.k = level.x < 900 ? 15 : 5;
  found = compare_psychometric(groups, model);
  CHECK(found.fits[2].status == PsychometricStatus::not_increasing);
  CHECK(found.fits[3].status == PsychometricStatus::not_increasing);
  groups[0] = groups[1] = {{1, 10, 0}, {2, 10, 0}, {3, 10, 10}, {4, 10, 10}};
  found = compare_psychometric(groups, model);
  for (const SharingFit& fit : found.fits) CHECK(fit.status == PsychometricStatus::separated);
  CHECK_THROWS_AS(compare_psychometric(Groups{kComparison}, model), std::invalid_argument);
}

TEST_CASE("under equal functions the tests reject about as often as they say", "[psychometric]") {
  std::mt19937_64 generator(21);
  constexpr int kRuns = 300;
  int location = 0, slope = 0, valid = 0;
  for (int run = 0; run < kRuns; ++run) {
    Groups groups;
    for (int g = 0; g < 2; ++g)
      groups.push_back(
          simulated(PsychometricFunction::logistic, truth_of(PsychometricFunction::logistic), 0, 0, 30, generator));
    const PsychometricComparison found = compare_psychometric(groups, {});
    if (found.tests[0].status != PsychometricStatus::ok || found.tests[3].status != PsychometricStatus::ok) continue;
    ++valid;
    location += found.tests[0].p < 0.1 ? 1 : 0;
    slope += found.tests[3].p < 0.1 ? 1 : 0;
  }
  CHECK(valid > 290);
  // 10 % of 300 is 30; four binomial standard deviations are 21.
  CHECK((location > 9 && location < 51));
  CHECK((slope > 9 && slope < 51));
}

}  // namespace
}  // namespace jnd
