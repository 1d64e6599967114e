// Fits of psychometric functions against R 4.2.2, against the likelihood written down directly, and what statuses mean.
#include "analysis/psychometric/psychometric.h"

#include <cmath>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <string>

#include <nlohmann/json.hpp>

#include "analysis/numerics/special_values.h"
#include "analysis/selftest/reference_numbers.h"
#include "tests/analysis/psychometric/psychometric_fixtures.h"
#include "tests/catch.h"

namespace jnd {
namespace {

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

}  // namespace
}  // namespace jnd
