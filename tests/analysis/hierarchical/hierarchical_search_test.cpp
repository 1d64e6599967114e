// What a search knows of the neighbourhood of a maximum.
#include "analysis/hierarchical/hierarchical_search.h"

#include <cmath>

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
  constexpr std::size_t kAll = 10;  // mu, kappa, tu^2, tv^2, tw^2, rho
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
  const HierarchicalPlace alone = moved(held, maximum.place),
                          together = moved(held, maximum.place, maximum.information);
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

}  // namespace
}  // namespace jnd
