// What a search knows of the neighbourhood of a maximum.
#include "analysis/hierarchical/hierarchical_search.h"

#include <cmath>
#include <vector>

#include "analysis/hierarchical/hierarchical_information.h"
#include "tests/analysis/hierarchical/hierarchical_fixtures.h"
#include "tests/catch.h"

namespace jnd {
namespace {

using namespace jnd::testing;

TEST_CASE("the observed information is minus the second derivatives", "[hierarchical]") {
  HierarchicalLikelihood likelihood(published_study(18, 3), ResponseModel::yes_no, {});
  const HierarchicalForm form = HierarchicalForm::separate(3);
  HierarchicalMaximum maximum = maximise(likelihood, form, published_truth());
  REQUIRE(maximum.converged);
  observe_information(likelihood, form, maximum);
  constexpr double kNudge = 1e-3;
  constexpr std::size_t kAll = 16;  // mu, kappa, tu^2, tv^2, tw^2, rho, shared parameters
  const auto slope_at = [&](std::size_t c, double nudge) {
    HierarchicalPlace place = maximum.place;
    place.mu[c] += nudge;
    return likelihood.at(place).slope;
  };
  for (std::size_t c = 0; c < 3; ++c) {
    const HierarchicalPlace above = slope_at(c, kNudge), below = slope_at(c, -kNudge);
    for (std::size_t other = 0; other < 3; ++other) {
      CAPTURE(c, other);
      const double scale = maximum.information[c * kAll + c];
      CHECK(std::abs(maximum.information[c * kAll + other] - (below.mu[other] - above.mu[other]) / (2 * kNudge)) <
            0.03 * scale);
      CHECK(std::abs(maximum.information[c * kAll + 3 + other] -
                     (below.kappa[other] - above.kappa[other]) / (2 * kNudge)) < 0.03 * scale);
    }
  }
}

TEST_CASE("with one mean moved, the rest of a place goes most of the way to its best", "[hierarchical]") {
  HierarchicalLikelihood likelihood(published_study(18, 3), ResponseModel::yes_no, {});
  const HierarchicalForm form = HierarchicalForm::separate(3);
  HierarchicalMaximum maximum = maximise(likelihood, form, published_truth());
  observe_information(likelihood, form, maximum);
  const double elsewhere = maximum.place.mu[0] + 0.1;
  const HierarchicalForm held = form.with_mean(0, elsewhere);
  const HierarchicalPlace alone = moved(held, maximum.place), together = moved(held, maximum, maximum.shared).place;
  CHECK(alone.mu[0] == elsewhere);
  CHECK(together.mu[0] == elsewhere);
  CHECK(alone.kappa == maximum.place.kappa);
  const double best = maximise(likelihood, held, maximum.place).log_likelihood;
  CHECK(best - likelihood.at(together).log_likelihood < 0.1 * (best - likelihood.at(alone).log_likelihood));
  CHECK(best < maximum.log_likelihood);
}

TEST_CASE("a search that knows the curvature ends at the same place", "[hierarchical]") {
  HierarchicalLikelihood likelihood(published_study(12, 4), ResponseModel::yes_no, {});
  const HierarchicalForm form = HierarchicalForm::separate(3);
  const HierarchicalMaximum plain = maximise(likelihood, form, published_truth());
  const HierarchicalMaximum again = maximise(likelihood, form, published_truth(), 1, kNegligible, plain.information);
  CHECK(again.log_likelihood == Approx(plain.log_likelihood).margin(1e-7));
  CHECK(again.place.mu[1] == Approx(plain.place.mu[1]).margin(1e-4));
}

TEST_CASE("slopes by what is the same for everybody are those of ln L", "[hierarchical]") {
  std::vector<HierarchicalCell> cells = published_study(1, 6);
  std::size_t number = 0;
  for (HierarchicalCell& cell : cells) {
    cell.second_half = number++ % 3 == 0;
    cell.sure_positive = std::floor(cell.positive / 2);
    cell.sure_negative = std::floor(cell.negative / 3);
  }
  SharedParameters some{.lapse = 0.06, .overdispersion = 0.1, .drift_ln_s = 0.2, .drift_criterion = -0.1};
  some.sure_above = 0.9;
  some.sure_below = 0.7;
  SharedForm all;
  for (const SharedParameter which : kSharedParameters) all = all.with(which);
  for (const ResponseModel model : {ResponseModel::yes_no, ResponseModel::choice}) {
    HierarchicalPlace place = published_truth();
    if (model == ResponseModel::choice) place.kappa = {20, -10, 30};
    if (model == ResponseModel::choice) place.tw = 40;
    const double unit = model == ResponseModel::choice ? 200 : 1;
    SharedParameters here = some;
    for (const SharedParameter which : kSharedParameters)
      if (of_criterion(which)) value_of(here, which) *= unit;
    HierarchicalLikelihood likelihood(cells, model, here);
    const OfSharedParameters slope = likelihood.at(place, all).by_shared;
    for (const SharedParameter which : kSharedParameters) {
      const double step = 0.01 * std::abs(value_of(here, which));
      const auto beside = [&](double steps) {
        SharedParameters there = here;
        value_of(there, which) += steps * step;
        likelihood.set_shared(there);
        return likelihood.at(place).log_likelihood;
      };
      const double expected = (8 * (beside(1) - beside(-1)) - (beside(2) - beside(-2))) / (12 * step);
      CAPTURE(static_cast<int>(model), static_cast<int>(which), expected);
      CHECK(std::abs(slope[static_cast<std::size_t>(which)] - expected) < 1e-3 * (1 / unit + std::abs(expected)));
    }
  }
}

}  // namespace
}  // namespace jnd
