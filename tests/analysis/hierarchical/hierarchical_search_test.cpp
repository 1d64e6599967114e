// What a search knows of the neighbourhood of a maximum.
#include "analysis/hierarchical/hierarchical_search.h"

#include <cmath>
#include <set>
#include <vector>

#include "analysis/hierarchical/hierarchical_fit.h"
#include "tests/analysis/hierarchical/hierarchical_fixtures.h"
#include "tests/catch.h"

namespace jnd {
namespace {

using namespace jnd::testing;

TEST_CASE("about a maximum means vary as ln L falls beside it", "[hierarchical]") {
  HierarchicalAnalysis analysis(published_study(18, 3), {});
  const std::vector<double> covariance = analysis.covariance();
  REQUIRE(covariance.size() == 9);
  const auto at = [&](std::size_t a, std::size_t b) { return covariance[3 * a + b]; };
  const auto curvature = [](auto&& drop, double estimate) {
    constexpr double kNudge = 0.02;
    return (drop(estimate + kNudge) + drop(estimate - kNudge)) / (kNudge * kNudge);
  };
  for (std::size_t c = 0; c < 3; ++c) {
    const std::size_t other = (c + 1) % 3;
    const double mu = analysis.fit().conditions[c].mu, beside = analysis.fit().conditions[other].mu;
    CHECK(curvature([&](double value) { return analysis.drop_of_mean(c, value); }, mu) ==
          Approx(1 / at(c, c)).epsilon(0.03));
    CHECK(curvature([&](double value) { return analysis.drop_of_difference(c, other, value); }, mu - beside) ==
          Approx(1 / (at(c, c) + at(other, other) - 2 * at(c, other))).epsilon(0.03));
  }
}

TEST_CASE("where work runs out JNDs come before ratios, which the curvature gives, and what is finished stays",
          "[hierarchical][long]") {
  const std::vector<HierarchicalCell> cells = published_study(6, 4);
  const auto with = [&cells](double most_work, int threads) {
    HierarchicalAnalysis analysis(cells, {});
    return analysis.complete({.intervals = true, .pairs = analysis.pairs(), .most_work = most_work}, threads);
  };
  const auto ends_of = [](const HierarchicalFit& fit) {
    std::vector<ProfileEnds> ends;
    for (const ConditionMean& one : fit.conditions) ends.push_back(one.ends);
    for (const ConditionDifference& one : fit.differences) ends.push_back(one.ends);
    return ends;
  };
  const std::vector<ProfileEnds> all = ends_of(with(13e9, 1));
  REQUIRE(all.size() == 6);
  std::set<std::size_t> counts;
  for (const double most_work : {0.0, 1.2e8, 1.9e8, 13e9}) {
    const std::vector<ProfileEnds> ends = ends_of(with(most_work, 1)), of_two = ends_of(with(most_work, 2));
    std::size_t finished = 0;
    for (std::size_t i = 0; i < 6; ++i) {
      CAPTURE(most_work, i);
      CHECK(of_two[i].status == ends[i].status);
      if (ends[i].status == EndsStatus::by_curvature) {
        const double width = all[i].high - all[i].low;
        CHECK(ends[i].low == Approx(all[i].low).margin(0.15 * width));
        CHECK(ends[i].high == Approx(all[i].high).margin(0.15 * width));
        continue;
      }
      CHECK(finished == i);
      ++finished;
      for (const std::vector<ProfileEnds>* other : {&all, &of_two}) {
        CHECK(ends[i].low == (*other)[i].low);
        CHECK(ends[i].high == (*other)[i].high);
      }
    }
    counts.insert(finished);
  }
  CHECK(counts.size() == 4);
}

TEST_CASE("a search that knows the curvature ends at the same place", "[hierarchical]") {
  HierarchicalLikelihood likelihood(published_study(12, 4), ResponseModel::yes_no, {});
  const HierarchicalForm form = HierarchicalForm::separate(3);
  HierarchicalMaximum start = maximise(likelihood, form, published_truth());
  const double best = start.log_likelihood, mu = start.place.mu[1];
  REQUIRE_FALSE(start.curvature.empty());
  start.place = published_truth();
  const HierarchicalMaximum again = jnd::maximise(likelihood, form, start);
  CHECK(again.log_likelihood == Approx(best).margin(1e-7));
  CHECK(again.place.mu[1] == Approx(mu).margin(1e-4));
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
