// No maximum of the likelihood is overlooked, and what must hold for any counts.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

#include <rapidcheck.h>

#include "analysis/numerics/binomial.h"
#include "analysis/psychometric/psychometric_interval.h"
#include "analysis/psychometric/psychometric_likelihood.h"
#include "tests/analysis/psychometric/psychometric_fixtures.h"
#include "tests/catch.h"

namespace jnd {
namespace {

// No maximum of the likelihood is overlooked: against searches from many random places.

using namespace jnd::testing;
using Place = PsychometricLikelihood::Place;
using Generator = std::mt19937_64;

double uniform(Generator& generator, double low, double high) {
  return low + (high - low) * (static_cast<double>(generator() >> 11U) + 0.5) * 0x1p-53;
}
int below(Generator& generator, int n) {
  return static_cast<int>(generator() % static_cast<std::uint64_t>(n));
}

struct DrawnTable {
  PsychometricModel model;
  std::vector<PsychometricLevel> levels;
};

// Small tables, one trial at each of up to 120 levels, and a few trials at irregular levels, some of them by chance.
DrawnTable drawn_by_seed(std::uint64_t seed) {
  Generator g(seed);
  DrawnTable drawn;
  drawn.model.function = kFunctions[below(g, 4)];
  constexpr double kGuesses[] = {0, 0.02, 0.25, 0.5}, kLapses[] = {0, 0.01, 0.05};
  drawn.model.guess = kGuesses[below(g, 4)];
  drawn.model.lapse = kLapses[below(g, 3)];
  const int free = below(g, 5);
  if (free == 0 || free == 1 || free == 3) drawn.model.lapse.reset();
  if (free == 2 || free == 3) drawn.model.guess.reset();
  if (!drawn.model.lapse && below(g, 6) == 0) drawn.model.estimator = PsychometricEstimator::map;
  const double guess = drawn.model.guess.value_or(uniform(g, 0, 0.3)), lapse = uniform(g, 0, 0.15);
  const int kind = below(g, 3);
  const int levels = kind == 0 ? 3 + below(g, 7) : kind == 1 ? 8 + below(g, 113) : 4 + below(g, 20);
  const double location = uniform(g, 2, 7), width = std::exp(uniform(g, std::log(0.05), std::log(4)));
  for (int i = 0; i < levels; ++i) {
    PsychometricLevel level;
    level.x = kind == 0   ? 1 + i * 7.0 / (levels - 1)
              : kind == 1 ? 1 + 7 * std::floor(uniform(g, 0, 1000)) / 1000
                          : uniform(g, 1, 8);
    level.n = kind == 1 ? 1 : 1 + below(g, kind == 0 ? 40 : 6);
    double p = guess + (1 - guess - lapse) / (1 + std::exp((location - level.x) / width));
    if (kind == 2 && below(g, 4) == 0) p = uniform(g, 0, 1);
    for (int trial = 0; trial < level.n; ++trial) level.k += uniform(g, 0, 1) < p ? 1 : 0;
    drawn.levels.push_back(level);
  }
  return drawn;
}

// Some levels of these data with another one beside them, nearer than any function could rise in between.
DrawnTable with_twins(std::uint64_t seed) {
  Generator g(seed);
  DrawnTable drawn = drawn_by_seed(seed);
  const int twins = 1 + below(g, 3);
  for (int i = 0; i < twins; ++i) {
    PsychometricLevel twin = drawn.levels[static_cast<std::size_t>(below(g, static_cast<int>(drawn.levels.size())))];
    twin.x = std::nextafter(twin.x, 1e9);
    twin.k = below(g, twin.n + 1);
    drawn.levels.push_back(twin);
  }
  return drawn;
}

// The best of searches from random places (-1e300 where none of them is possible): half of them near a level, steep
// ones as often as flat ones.
double best_of_searches(const PsychometricLikelihood& likelihood, std::uint64_t seed, int searches) {
  Generator g(seed);
  const PsychometricData& data = likelihood.data();
  const NewtonBox& box = likelihood.box();
  double nearest = data.range(), best = -1e300;
  for (std::size_t i = 1; i < data.levels(); ++i) nearest = std::min(nearest, data.t[i] - data.t[i - 1]);
  const double middle = psychometric_shape_quantile(data.function, 0.5);
  for (int search = 0; search < searches; ++search) {
    const double steepest = std::min(1e4, 10 * data.range() / nearest);
    const double c1 = std::exp(uniform(g, std::log(0.2), std::log(steepest))) / data.range();
    double t = data.t.front() + data.range() * uniform(g, -0.3, 1.3);
    if (search % 2 == 1)
      t = data.t[static_cast<std::size_t>(below(g, static_cast<int>(data.levels())))] + uniform(g, -3, 3) / c1;
    std::vector<double> place = {middle - c1 * t, c1, 0, 0};
    for (const Place rate : {Place::lapse, Place::guess}) {
      double part = uniform(g, 0, 1);
      if (part < 0.15) part = 1e-6;
      if (part > 0.85) part = 1;
      place[rate] = box.lower[rate] + part * (box.upper[rate] - box.lower[rate]);
    }
    if (std::isfinite(likelihood.value(place))) best = std::max(best, maximise_in_box(likelihood, place, box).value);
  }
  return best;
}

struct Searched {
  int compared = 0, missed = 0;
};

Searched searched(DrawnTable (*data_of)(std::uint64_t), std::uint64_t from, std::uint64_t to, int searches) {
  Searched result;
  for (std::uint64_t seed = from; seed < to; ++seed) {
    const DrawnTable drawn = data_of(seed);
    const PsychometricSolution solution = solve_psychometric(drawn.levels, drawn.model);
    const PsychometricData& data = solution.likelihood.data();
    if (data.answers == 0 || data.answers == data.trials || solution.fit.degrees_of_freedom < 0) continue;
    const double found = best_of_searches(solution.likelihood, seed + 1'000'003, searches);
    if (found == -1e300) continue;
    ++result.compared;
    if (found <= solution.value + 1e-6) continue;
    ++result.missed;
    UNSCOPED_INFO("seed " << seed << ": " << found << " instead of " << solution.value);
  }
  return result;
}

TEST_CASE("no search from a random place ends higher than the fit", "[psychometric]") {
  const Searched many = searched(drawn_by_seed, 0, 200, 30);
  CHECK(many.missed == 0);
  CHECK(many.compared >= 150);
  // Data on which the searches from the best of a coarse grid of each pair of rates ended lower.
  for (const std::uint64_t seed : {201, 281, 931, 971, 1349, 1366}) {
    CAPTURE(seed);
    const Searched one = searched(drawn_by_seed, seed, seed + 1, 80);
    CHECK(one.missed == 0);
    CHECK(one.compared == 1);
  }
}

TEST_CASE("a search ends, and misses nothing, where levels differ only by rounding", "[psychometric]") {
  const Searched many = searched(with_twins, 0, 60, 15);
  CHECK(many.missed == 0);
  CHECK(many.compared >= 45);
  const std::vector<PsychometricLevel> levels = {
      {0.1, 5, 0}, {0.2, 5, 0}, {0.3, 5, 2}, {0.30000000000000004, 5, 4}, {0.4, 5, 5}};
  PsychometricModel model;
  model.lapse.reset();
  for (const PsychometricFunction function : kFunctions) {
    CAPTURE(to_string(function));
    model.function = function;
    // A step through both, with 0.6 at them, and the rates themselves.
    const double step = 6 * std::log(0.6) + 4 * std::log(0.4);
    const double saturated = 2 * std::log(0.4) + 3 * std::log(0.6) + 4 * std::log(0.8) + std::log(0.2);
    const PsychometricFit fit = fit_psychometric(levels, model);
    CHECK(fit.log_likelihood >= step - 1e-6);
    CHECK(fit.log_likelihood <= saturated + 1e-6);
    const ConfidenceBounds lapse = psychometric_profile(levels, model).lapse;
    CHECK(lapse.low <= lapse.high);
  }
}

TEST_CASE("levels with the same logarithm are one level of the Weibull function", "[psychometric]") {
  const double x = 0.1, beside = std::nextafter(x, 1.0);
  REQUIRE(std::log(x) == std::log(beside));
  PsychometricModel model;
  model.function = PsychometricFunction::weibull;
  model.guess = model.lapse = 0.02;
  CHECK(fit_psychometric(std::vector<PsychometricLevel>{{x, 5, 2}, {beside, 5, 4}}, model).status ==
        PsychometricStatus::not_identified);
  const PsychometricFit two =
      fit_psychometric(std::vector<PsychometricLevel>{{0.05, 9, 1}, {x, 5, 2}, {beside, 5, 4}, {0.2, 9, 8}}, model);
  const PsychometricFit one =
      fit_psychometric(std::vector<PsychometricLevel>{{0.05, 9, 1}, {x, 10, 6}, {0.2, 9, 8}}, model);
  CHECK(two.levels == 3);
  CHECK(two.log_likelihood == one.log_likelihood);
  CHECK(two.pse.value == one.pse.value);
}

// By hand: tests/README.md.
TEST_CASE("no search from a random place ends higher than the fit: ten thousand data sets", "[.][search-campaign]") {
  const Searched many = searched(drawn_by_seed, 0, 10'000, 80);
  CHECK(many.missed == 0);
  CHECK(many.compared >= 7'500);
}

TEST_CASE("freeing a rate never lowers the likelihood", "[psychometric]") {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    DrawnTable drawn = drawn_by_seed(seed);
    drawn.model.estimator = PsychometricEstimator::ml;
    drawn.model.guess = 0.02;
    drawn.model.lapse = 0.05;
    const auto value = [&] { return fit_psychometric(drawn.levels, drawn.model).log_likelihood; };
    const double known = value();
    drawn.model.lapse.reset();
    const double free_lapse = value();
    drawn.model.guess.reset();
    const double free_both = value();
    CAPTURE(seed, known, free_lapse, free_both);
    if (std::isnan(free_both)) continue;
    CHECK(free_lapse >= known - 1e-9);
    CHECK(free_both >= free_lapse - 1e-9);
  }
}

// What must hold for any counts: invariances, derivatives against finite differences, and no better place to be found.

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
