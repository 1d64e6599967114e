// Goodness of fit: closed cases, degrees of freedom, and the size of its tests under a model that holds.
#include "analysis/thresholds/fit_quality.h"

#include <cmath>
#include <stdexcept>
#include <vector>

#include "analysis/numerics/normal.h"
#include "analysis/thresholds/jnd_bootstrap.h"
#include "tests/catch.h"

namespace jnd {
namespace {

constexpr JndMethod kFitted[] = {JndMethod::ml_yes_no_common, JndMethod::ml_yes_no_series,
                                 JndMethod::ml_differencing_common, JndMethod::ml_differencing_series};

TEST_CASE("one series is always fitted perfectly: no degrees of freedom, no p", "[analysis][fit]") {
  const std::vector<SeriesCounts> one = {{400, {20, 15, 20, 4}}};
  for (const JndMethod method : kFitted) {
    const FitQuality found = fit_quality(one, method, 10, 1);
    CHECK(found.status == FitStatus::no_degrees_of_freedom);
    CHECK(found.cells == 2);
    CHECK(found.degrees_of_freedom == 0);
    CHECK(found.deviance == Approx(0).margin(1e-9));
    CHECK(std::isnan(found.deviance_p));
    CHECK(std::isnan(found.pearson_p_bootstrap));
    CHECK(found.replicates == 0);
  }
}

TEST_CASE("deviance and chi-square of equal rates in a two-by-two table", "[analysis][fit]") {
  // With a common criterion and contradicting d', the best slope of these two series is 0 by symmetry, and the fit is
  // one rate of 0.5 for all four cells. 2 sum k log(k / 5) and sum (k - 5)^2 / 2.5 over 8, 5 and 2, 5 of 10.
  const std::vector<SeriesCounts> series = {{300, {10, 8, 10, 5}}, {300, {10, 2, 10, 5}}};
  const FitQuality found = fit_quality(series, JndMethod::ml_yes_no_common, 0, 1);
  const double deviance = 2 * 2 * (8 * std::log(1.6) + 2 * std::log(0.4));
  CHECK(found.status == FitStatus::ok);
  CHECK(found.degrees_of_freedom == 2);
  CHECK(found.deviance == Approx(deviance).epsilon(1e-10));
  CHECK(found.pearson == Approx(2 * 9 / 2.5).epsilon(1e-10));
  CHECK(found.deviance_p == Approx(std::exp(-deviance / 2)).epsilon(1e-10));  // chi-square with 2 degrees of freedom
  CHECK(found.pearson_p == Approx(std::exp(-3.6)).epsilon(1e-10));
  CHECK(std::isnan(found.deviance_p_bootstrap));
}

TEST_CASE("too few trials per cell for chi-square leave the bootstrap's p", "[analysis][fit]") {
  const std::vector<SeriesCounts> few = {{400, {4, 3, 4, 1}}, {200, {4, 2, 4, 1}}};
  const FitQuality found = fit_quality(few, JndMethod::ml_yes_no_common, 50, 1);
  CHECK(found.status == FitStatus::few_trials);
  CHECK(std::isnan(found.deviance_p));
  CHECK(std::isnan(found.pearson_p));
  CHECK((found.deviance_p_bootstrap > 0 && found.deviance_p_bootstrap <= 1));
}

TEST_CASE("degrees of freedom count cells less parameters; missing series are left out", "[analysis][fit]") {
  const std::vector<SeriesCounts> series = {
      {400, {6, 5, 6, 1}}, {300, {6, 4, 6, 1}}, {250, {12, 9, 0, 0}}, {200, {6, 3, 6, 2}}};
  CHECK(fit_quality(series, JndMethod::ml_yes_no_common, 0, 1).degrees_of_freedom == 4);
  CHECK(fit_quality(series, JndMethod::ml_yes_no_series, 0, 1).degrees_of_freedom == 2);
  CHECK(fit_quality(series, JndMethod::ml_differencing_series, 0, 1).cells == 6);
  const std::vector<SeriesCounts> constant = {{400, {6, 0, 6, 0}}, {200, {6, 0, 6, 0}}};
  const FitQuality none = fit_quality(constant, JndMethod::ml_yes_no_series, 10, 1);
  CHECK(none.status == FitStatus::no_information);
  CHECK(std::isnan(none.deviance));
  CHECK_THROWS_AS(fit_quality(series, JndMethod::least_squares, 10, 1), std::invalid_argument);
}

TEST_CASE("a fit at the ceiling is judged by its limit", "[analysis][fit]") {
  const std::vector<SeriesCounts> every_hit = {{400, {6, 6, 6, 0}}, {200, {6, 6, 6, 0}}};
  for (const JndMethod method : kFitted) {
    const FitQuality found = fit_quality(every_hit, method, 20, 1);
    CHECK(found.deviance == 0);
    CHECK(found.pearson == 0);
    CHECK(found.status == FitStatus::few_trials);  // no answer but those that the limit expects
    CHECK(std::isnan(found.deviance_p));
    CHECK(found.deviance_p_bootstrap == 1);
  }
  // One criterion, separated at 0: the false alarms of both series share a rate of 4/12.
  const std::vector<SeriesCounts> pooled = {{400, {6, 6, 6, 1}}, {200, {6, 6, 6, 3}}};
  const FitQuality found = fit_quality(pooled, JndMethod::ml_yes_no_common, 0, 1);
  CHECK(found.pearson == Approx(2 / (6 * (1.0 / 3) * (2.0 / 3))).epsilon(1e-12));
}

TEST_CASE("a wrong model of many trials is found out, the right one is not", "[analysis][fit]") {
  // d' = 0.5, 1.2, 3 at 200, 300, 400: not proportional to the difference.
  const double dprime[] = {0.5, 1.2, 3.0};
  std::vector<SeriesCounts> bent, straight;
  for (int i = 0; i < 3; ++i) {
    const double difference = 200 + 100.0 * i;
    const auto count = [](double z) { return static_cast<int>(std::lround(500 * normal_cdf(z))); };
    bent.push_back({difference, {500, count(-0.7 + dprime[i]), 500, count(-0.7)}});
    straight.push_back({difference, {500, count(-0.7 + difference / 208.5), 500, count(-0.7)}});
  }
  const FitQuality wrong = fit_quality(bent, JndMethod::ml_yes_no_series, 99, 1);
  CHECK(wrong.deviance_p < 1e-6);
  CHECK(wrong.deviance_p_bootstrap == Approx(0.01));
  CHECK(wrong.pearson_p_bootstrap == Approx(0.01));
  const FitQuality right = fit_quality(straight, JndMethod::ml_yes_no_series, 99, 1);
  CHECK(right.deviance_p > 0.9);
  CHECK(right.deviance_p_bootstrap > 0.8);
}

TEST_CASE("p values of a model that holds are spread evenly", "[analysis][fit]") {
  std::vector<SeriesCounts> truth;
  std::vector<double> hits, alarms;
  for (const double difference : {400.0, 300.0, 200.0}) {
    truth.push_back({difference, {40, 0, 40, 0}});
    hits.push_back(normal_cdf(-0.7 + difference / 250));
    alarms.push_back(normal_cdf(-0.7));
  }
  const CountsSampler sampler(truth, hits, alarms);
  std::vector<SeriesCounts> drawn;
  int below_tenth = 0, below_half = 0;
  constexpr int kStudies = 400;
  for (int study = 0; study < kStudies; ++study) {
    ExperimentStream stream(5, 17, static_cast<std::uint64_t>(study));
    sampler.draw(stream, drawn);
    const double p =
        fit_quality(drawn, JndMethod::ml_yes_no_common, 39, static_cast<std::uint64_t>(study)).deviance_p_bootstrap;
    below_tenth += p <= 0.1 ? 1 : 0;
    below_half += p <= 0.5 ? 1 : 0;
  }
  // Four standard errors of 400 studies: 6 % and 10 %.
  CHECK(below_tenth / 400.0 == Approx(0.1).margin(0.06));
  CHECK(below_half / 400.0 == Approx(0.5).margin(0.1));
}

}  // namespace
}  // namespace jnd
