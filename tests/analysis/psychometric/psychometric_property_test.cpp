// What must hold for any counts: invariances, derivatives against finite differences, and no better place to be found.
#include <algorithm>
#include <cmath>
#include <random>

#include <rapidcheck.h>

#include "analysis/numerics/binomial.h"
#include "analysis/psychometric/psychometric_likelihood.h"
#include "tests/analysis/psychometric/psychometric_fixtures.h"
#include "tests/catch.h"

namespace jnd {
namespace {

using namespace jnd::testing;

PsychometricModel model_of(PsychometricFunction function, bool forced_choice, bool free_lapse) {
  PsychometricModel model;
  model.function = function;
  model.guess = forced_choice ? 0.5 : 0.0;
  if (free_lapse) model.lapse.reset();
  return model;
}

struct Drawn {
  PsychometricModel model;
  std::vector<PsychometricLevel> levels;
};

Drawn any_data(bool forced_choice_too = true) {
  const PsychometricFunction function = *rc::gen::elementOf(
      std::vector<PsychometricFunction>({PsychometricFunction::logistic, PsychometricFunction::gaussian,
                                         PsychometricFunction::weibull, PsychometricFunction::gumbel}));
  const bool forced_choice = *rc::gen::arbitrary<bool>(), free_lapse = *rc::gen::arbitrary<bool>();
  Drawn drawn;
  drawn.model = model_of(function, forced_choice && forced_choice_too, free_lapse);
  std::mt19937_64 generator(static_cast<std::uint64_t>(*rc::gen::inRange(0, 1'000'000)));
  Truth truth = truth_of(function);
  truth.location *= *rc::gen::inRange(60, 150) / 100.0;
  truth.second *= *rc::gen::inRange(60, 200) / 100.0;
  drawn.levels = simulated(function, truth, drawn.model.guess.value_or(0), 0.03, *rc::gen::inRange(10, 60), generator,
                           *rc::gen::inRange(4, 9));
  return drawn;
}

bool close(double a, double b, double relative) {
  return a == b || (std::isnan(a) && std::isnan(b)) || std::abs(a - b) <= relative * std::max(std::abs(a), std::abs(b));
}

TEST_CASE("the derivatives of the likelihood agree with finite differences", "[psychometric]") {
  for (const PsychometricFunction function : kFunctions) {
    PsychometricModel model = model_of(function, true, true);
    model.guess.reset();
    model.estimator = PsychometricEstimator::map;
    const PsychometricLikelihood likelihood(psychometric_data(kForcedChoice, model), model);
    for (const std::vector<double>& place :
         {std::vector<double>{0.3, 4, 0.04, 0.3}, std::vector<double>{-1, 9, 0.09, 0.1}}) {
      NewtonDerivatives at, up, down;
      likelihood.derivatives(place, at);
      CHECK(at.value == Approx(likelihood.value(place)).epsilon(1e-13));
      for (std::size_t i = 0; i < place.size(); ++i) {
        const double h = 1e-5;
        std::vector<double> more = place, less = place;
        more[i] += h;
        less[i] -= h;
        CAPTURE(to_string(function), i);
        CHECK(at.gradient[i] ==
              Approx((likelihood.value(more) - likelihood.value(less)) / (2 * h)).epsilon(1e-5).margin(1e-4));
        likelihood.derivatives(more, up);
        likelihood.derivatives(less, down);
        for (std::size_t j = 0; j < place.size(); ++j)
          CHECK(at.curvature[i * 4 + j] ==
                Approx(-(up.gradient[j] - down.gradient[j]) / (2 * h)).epsilon(1e-5).margin(1e-3));
      }
    }
    for (double u = -6; u < 3; u += 0.37) {
      const double h = 1e-5;
      const PsychometricShape at = psychometric_shape(function, u), more = psychometric_shape(function, u + h),
                              less = psychometric_shape(function, u - h);
      CHECK(at.first == Approx((more.g - less.g) / (2 * h)).epsilon(1e-6).margin(1e-10));
      CHECK(at.second == Approx((more.first - less.first) / (2 * h)).epsilon(1e-6).margin(1e-9));
      CHECK(at.g + at.upper == Approx(1).epsilon(1e-15));
      CHECK(psychometric_shape_quantile(function, at.g) == Approx(u).epsilon(1e-9).margin(1e-9));
    }
  }
}

TEST_CASE("the fit is never less likely than the truth or a grid of functions", "[psychometric]") {
  std::mt19937_64 generator(7);
  int estimates = 0;
  for (const PsychometricFunction function : kFunctions)
    for (const bool forced_choice : {false, true})
      for (const bool free_lapse : {false, true})
        for (int run = 0; run < 25; ++run) {
          const PsychometricModel model = model_of(function, forced_choice, free_lapse);
          const double guess = forced_choice ? 0.5 : 0, lapse = free_lapse ? 0.03 : 0;
          const Truth truth = truth_of(function);
          const auto levels = simulated(function, truth, guess, lapse, 12, generator, 6);
          const PsychometricFit fit = fit_psychometric(levels, model);
          if (std::isnan(fit.log_likelihood)) continue;
          estimates += is_estimate(fit.status) ? 1 : 0;
          double most = plain_log_likelihood(levels, function, truth.location, truth.second, guess, lapse);
          for (const double at : {0.2, 0.5, 0.7, 0.8, 0.9, 1.0, 1.1, 1.25, 1.4, 1.8, 3.0})
            for (const double steep : {0.1, 0.3, 0.5, 0.8, 1.0, 1.3, 2.0, 4.0, 9.0})
              for (const double missed : {0.0, 0.01, 0.03, 0.06, 0.1})
                if (free_lapse || missed == 0)
                  most = std::max(most, plain_log_likelihood(levels, function, at * truth.location,
                                                             steep * truth.second, guess, missed));
          CAPTURE(to_string(function), forced_choice, free_lapse, run, to_string(fit.status));
          CHECK(fit.log_likelihood >= most - 1e-9);
        }
  CHECK(estimates > 200);
}

TEST_CASE("a rate that is known stays what it is, also where answers are rarer than guesses", "[psychometric]") {
  PsychometricModel model;
  model.guess = 0.5;
  for (const PsychometricFunction function : kFunctions) {
    CAPTURE(to_string(function));
    model.function = function;
    const PsychometricFit chance =
        fit_psychometric(std::vector<PsychometricLevel>{{1, 24, 11}, {2, 24, 14}, {3, 24, 13}, {4, 24, 9}}, model);
    CHECK(chance.status == PsychometricStatus::not_increasing);
    CHECK(chance.log_likelihood == Approx(96 * std::log(0.5)).epsilon(1e-12));
    // Without guessing the same function would fit these better.
    const std::vector<PsychometricLevel> low = {{1, 100, 30}, {2, 100, 45}, {3, 100, 60}, {4, 100, 75}, {5, 100, 90}};
    const PsychometricFit fit = fit_psychometric(low, model);
    REQUIRE(fit.status == PsychometricStatus::ok);
    CHECK(fit.guess.value == 0.5);
    CHECK(fit.log_likelihood ==
          Approx(plain_log_likelihood(low, function, fit.location.value, fit.second.value, 0.5, 0)).epsilon(1e-12));
  }
}

TEST_CASE("another unit of the levels scales what has a unit, and nothing else", "[psychometric]") {
  REQUIRE(rc::check("scaling by any factor", [] {
    const Drawn drawn = any_data();
    const double factor = std::exp2(*rc::gen::inRange(-20, 21)) * 1.7;
    std::vector<PsychometricLevel> scaled = drawn.levels;
    for (PsychometricLevel& level : scaled) level.x *= factor;
    const PsychometricFit one = fit_psychometric(drawn.levels, drawn.model),
                          other = fit_psychometric(scaled, drawn.model);
    RC_ASSERT(one.status == other.status);
    RC_ASSERT(close(one.log_likelihood, other.log_likelihood, 1e-10));
    RC_ASSERT(close(one.pse.value * factor, other.pse.value, 1e-5));
    RC_ASSERT(close(one.jnd.value * factor, other.jnd.value, 1e-5));
    RC_ASSERT(close(one.slope.value, other.slope.value * factor, 1e-5));
    RC_ASSERT(close(one.jnd.se * factor, other.jnd.se, 1e-4));
  }));
}

TEST_CASE("a shift of the levels shifts the PSE, but for the Weibull function", "[psychometric]") {
  REQUIRE(rc::check("shift by any number", [] {
    const Drawn drawn = any_data();
    if (drawn.model.function == PsychometricFunction::weibull) return;
    const double shift = *rc::gen::inRange(-1000, 1000);
    std::vector<PsychometricLevel> shifted = drawn.levels;
    for (PsychometricLevel& level : shifted) level.x += shift;
    const PsychometricFit one = fit_psychometric(drawn.levels, drawn.model),
                          other = fit_psychometric(shifted, drawn.model);
    RC_ASSERT(one.status == other.status);
    RC_ASSERT(close(one.log_likelihood, other.log_likelihood, 1e-10));
    RC_ASSERT(close(one.jnd.value, other.jnd.value, 1e-5));
    RC_ASSERT(std::isnan(one.pse.value) || std::abs(one.pse.value + shift - other.pse.value) <= 1e-5);
    RC_ASSERT(!is_estimate(one.status) || (std::isfinite(one.pse.value) && std::isfinite(one.jnd.value)));
  }));
}

TEST_CASE("every row twice is every count doubled, in any order", "[psychometric]") {
  REQUIRE(rc::check("doubling", [] {
    const Drawn drawn = any_data();
    std::vector<PsychometricLevel> rows = drawn.levels, doubled = drawn.levels;
    rows.insert(rows.end(), drawn.levels.rbegin(), drawn.levels.rend());
    for (PsychometricLevel& level : doubled) {
      level.n *= 2;
      level.k *= 2;
    }
    const PsychometricFit a = fit_psychometric(rows, drawn.model), b = fit_psychometric(doubled, drawn.model);
    RC_ASSERT(a.status == b.status);
    RC_ASSERT(close(a.pse.value, b.pse.value, 0) && close(a.deviance, b.deviance, 0) && close(a.jnd.se, b.jnd.se, 0));
    const PsychometricFit single = fit_psychometric(drawn.levels, drawn.model);
    if (!is_estimate(single.status) || !is_estimate(a.status)) return;
    RC_ASSERT(close(a.log_likelihood, 2 * single.log_likelihood, 1e-10));
    RC_ASSERT(close(a.pse.value, single.pse.value, 1e-5));
    RC_ASSERT(close(a.jnd.se * std::sqrt(2.0), single.jnd.se, 1e-4));
  }));
}

TEST_CASE("the symmetric functions mirror: k -> n - k and x -> -x", "[psychometric]") {
  REQUIRE(rc::check("mirror", [] {
    Drawn drawn = any_data(false);
    drawn.model.lapse = 0.0;
    drawn.model.function = *rc::gen::element(PsychometricFunction::logistic, PsychometricFunction::gaussian);
    std::vector<PsychometricLevel> mirrored = drawn.levels;
    for (PsychometricLevel& level : mirrored) level = {-level.x, level.n, level.n - level.k};
    const PsychometricFit one = fit_psychometric(drawn.levels, drawn.model),
                          other = fit_psychometric(mirrored, drawn.model);
    RC_ASSERT(one.status == other.status);
    RC_ASSERT(close(one.log_likelihood, other.log_likelihood, 1e-10));
    RC_ASSERT(close(one.second.value, other.second.value, 1e-6));
    RC_ASSERT(std::isnan(one.pse.value) || std::abs(one.pse.value + other.pse.value) <= 1e-6);
  }));
}

TEST_CASE("binomial draws by inversion follow the binomial distribution", "[psychometric]") {
  for (const int n : {1, 7, 40, 1000})
    for (const double p : {0.001, 0.3, 0.5, 0.97}) {
      const BinomialSampler sampler(n, p);
      // Draws at evenly spaced uniforms: their moments are the distribution's.
      constexpr int kPoints = 20'000;
      double mean = 0, square = 0;
      for (int i = 0; i < kPoints; ++i) {
        const double k = sampler.at((i + 0.5) / kPoints);
        mean += k / kPoints;
        square += k * k / kPoints;
      }
      CAPTURE(n, p);
      CHECK(mean == Approx(n * p).epsilon(1e-3).margin(1e-4));
      CHECK(square - mean * mean == Approx(n * p * (1 - p)).epsilon(0.01).margin(1e-4));
    }
  CHECK(BinomialSampler(5, 0).at(0.999) == 0);
  CHECK(BinomialSampler(5, 1).at(0.001) == 5);
  CHECK(BinomialSampler(2, 0.5).at(0.2) == 0);
  CHECK(BinomialSampler(2, 0.5).at(0.3) == 1);
  CHECK(BinomialSampler(2, 0.5).at(0.8) == 2);
}

}  // namespace
}  // namespace jnd
