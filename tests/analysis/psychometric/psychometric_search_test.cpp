// No maximum of the likelihood is overlooked: against searches from many random places.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

#include "analysis/psychometric/psychometric_interval.h"
#include "analysis/psychometric/psychometric_likelihood.h"
#include "tests/analysis/psychometric/psychometric_fixtures.h"
#include "tests/catch.h"

namespace jnd {
namespace {

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

}  // namespace
}  // namespace jnd
