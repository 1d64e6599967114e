// Draws of people against the moments of their posteriors, and where there is nothing to draw.
#include <cmath>

#include "analysis/hierarchical/predictive_check.h"
#include "tests/analysis/hierarchical/hierarchical_fixtures.h"
#include "tests/catch.h"

namespace jnd {
namespace {

using namespace jnd::testing;

// Largest distance of a mean and of a standard deviation of draws from the posterior's, in standard errors.
double distance_from_posterior(const std::vector<HierarchicalCell>& cells, const HierarchicalModel& model,
                               const HierarchicalPlace& place, std::size_t count) {
  const PosteriorDraws draws(cells, model, place, count, 7);
  HierarchicalLikelihood likelihood(cells, model.response, model.shared);
  const std::vector<PersonPosterior> posteriors = likelihood.posteriors(place);
  const auto n = static_cast<double>(count);
  double distance = 0;
  for (std::size_t p = 0; p < posteriors.size(); ++p)
    for (std::size_t c = 0; c < place.mu.size(); ++c) {
      double sum = 0, squares = 0, criterion = 0;
      for (std::size_t i = 0; i < count; ++i) {
        const double off = draws.ln_s(p, c, i) - posteriors[p].mean[c];
        sum += off;
        squares += off * off;
        criterion += draws.criterion(p, c, i);
      }
      const double sd = posteriors[p].sd[c];
      distance = std::max({distance, std::abs(sum / n) / sd * std::sqrt(n),
                           std::abs(std::sqrt(squares / n) / sd - 1) * std::sqrt(2 * n),
                           std::abs(criterion / n - place.kappa[c] - posteriors[p].w) / place.tw * std::sqrt(n)});
    }
  return distance;
}

TEST_CASE("draws of people have the moments of their posteriors", "[hierarchical]") {
  constexpr std::size_t kDraws = 2000;
  constexpr double kFar = 6;  // standard errors; posteriors have longer tails than normal densities
  const HierarchicalPlace truth = published_truth();
  SECTION("yes-no, and with the spreads correlated") {
    CHECK(distance_from_posterior(published_study(4, 1), {}, truth, kDraws) < kFar);
    HierarchicalPlace correlated = truth;
    correlated.rho = 0.6;
    CHECK(distance_from_posterior(published_study(4, 1), {}, correlated, kDraws) < kFar);
  }
  SECTION("many answers, and people who differ much from one condition to another") {
    std::vector<HierarchicalCell> cells = published_study(3, 2);
    for (HierarchicalCell& cell : cells) {
      cell.positive *= 10;
      cell.negative *= 10;
    }
    HierarchicalPlace wide = truth;
    wide.tv = 0.8;
    CHECK(distance_from_posterior(cells, {}, wide, kDraws) < kFar);
  }
  SECTION("the other observers") {
    HierarchicalModel differencing{.response = ResponseModel::differencing};
    HierarchicalPlace place = truth;
    place.kappa.assign(3, 0.5);
    CHECK(distance_from_posterior(published_study(3, 3), differencing, place, kDraws) < kFar);
    HierarchicalModel choice;
    choice.response = ResponseModel::choice;
    choice.shared.lapse = 0.02;
    place.kappa.assign(3, 30);
    place.tw = 60;
    CHECK(distance_from_posterior(published_study(3, 4), choice, place, kDraws) < kFar);
  }
}

TEST_CASE("of a spread of 0 nobody deviates, who has no answers is anybody, and a seed is a seed", "[hierarchical]") {
  std::vector<HierarchicalCell> cells = published_study(3, 5);
  HierarchicalPlace place = published_truth();
  for (HierarchicalCell& cell : cells)
    if (cell.participant == 1) cell.positive = cell.negative = 0;
  const PosteriorDraws draws(cells, {}, place, 1000, 3), again(cells, {}, place, 1000, 3),
      other(cells, {}, place, 9, 4);
  double sum = 0, squares = 0;
  for (std::size_t i = 0; i < 1000; ++i) {
    const double off = draws.ln_s(1, 2, i) - place.mu[2];
    sum += off;
    squares += off * off;
    CHECK(draws.ln_s(0, 1, i) == again.ln_s(0, 1, i));
  }
  CHECK(std::abs(sum / 1000) < 5 * std::hypot(place.tu, place.tv) / std::sqrt(1000.0));
  CHECK(std::sqrt(squares / 1000) == Approx(std::hypot(place.tu, place.tv)).epsilon(0.12));
  CHECK(draws.ln_s(0, 1, 0) != other.ln_s(0, 1, 0));
  place.tu = place.tv = place.tw = 0;
  const PosteriorDraws alike(cells, {}, place, 30, 3);
  for (std::size_t i = 0; i < 30; ++i) {
    CHECK(alike.ln_s(2, 0, i) == place.mu[0]);
    CHECK(alike.criterion(2, 0, i) == place.kappa[0]);
  }
}

}  // namespace
}  // namespace jnd
