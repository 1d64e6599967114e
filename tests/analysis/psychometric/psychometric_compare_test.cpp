// Nested comparisons of groups against maxima found by brute force on the likelihood written down directly.
#include "analysis/psychometric/psychometric_compare.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <stdexcept>

#include "analysis/psychometric/psychometric_joint.h"
#include "tests/analysis/psychometric/psychometric_fixtures.h"
#include "tests/catch.h"

namespace jnd {
namespace {

using namespace jnd::testing;
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
