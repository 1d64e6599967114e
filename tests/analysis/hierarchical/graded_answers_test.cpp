// Answers in four categories of sureness, and the observer of independent observations.
#include <cmath>
#include <utility>
#include <vector>

#include "analysis/detection/independent_observation.h"
#include "analysis/hierarchical/hierarchical_fit.h"
#include "analysis/numerics/normal.h"
#include "tests/analysis/hierarchical/hierarchical_fixtures.h"
#include "tests/catch.h"

namespace jnd {
namespace {

using namespace jnd::testing;

// By person, condition and level: same sure, same unsure, different unsure, different sure.
struct CategoryRow {
  int participant, condition;
  double level;
  double same_sure, same_unsure, different_unsure, different_sure;
};
constexpr CategoryRow kTwoPeople[] = {{0, 0, 0, 6, 5, 4, 1}, {0, 0, 200, 1, 2, 2, 1}, {0, 0, 400, 0, 1, 2, 5},
                                      {0, 1, 0, 7, 6, 2, 1}, {0, 1, 200, 2, 2, 1, 1}, {0, 1, 400, 0, 2, 3, 1},
                                      {1, 0, 0, 9, 4, 2, 0}, {1, 0, 200, 2, 1, 3, 0}, {1, 0, 400, 1, 0, 2, 3},
                                      {1, 1, 0, 8, 3, 4, 1}, {1, 1, 200, 3, 2, 1, 0}, {1, 1, 400, 1, 2, 2, 1}};

std::vector<HierarchicalCell> cells_of(std::span<const CategoryRow> rows, double same_level = 0) {
  std::vector<HierarchicalCell> cells;
  for (const CategoryRow& row : rows) {
    HierarchicalCell cell{row.participant, row.condition, row.level == 0 ? same_level : row.level,
                          row.different_unsure + row.different_sure, row.same_unsure + row.same_sure};
    cell.sure_positive = row.different_sure;
    cell.sure_negative = row.same_sure;
    cells.push_back(cell);
  }
  return cells;
}

// The sum over both persons of ln of the integral over u, w and v by the trapezoid rule (0.1 standard deviations apart,
// out to 8), from P(answer <= j | level) = 1 - F(level, s, c_j) with c = k - 0.7, k, k + 0.9; R 4.2.2, pnorm and qnorm.
TEST_CASE("the likelihood of answers with sureness is that of an independent integral, for every observer",
          "[hierarchical][sureness]") {
  HierarchicalPlace place;
  place.mu = {std::log(220), std::log(310)};
  place.kappa = {0.6, 0.75};
  place.tu = 0.35;
  place.tv = 0.2;
  place.tw = 0.3;
  place.rho = 0.4;
  const struct {
    ResponseModel model;
    double lapse, same_level, value;
  } cases[] = {
      {ResponseModel::yes_no, 0, 0, -138.923507182},         {ResponseModel::yes_no, 0.04, 0, -138.873542366},
      {ResponseModel::differencing, 0, 0, -146.571230653},   {ResponseModel::differencing, 0.04, 0, -144.461329857},
      {ResponseModel::independent, 0, -400, -142.250693293}, {ResponseModel::independent, 0.04, -400, -142.190179878}};
  for (const auto& one : cases) {
    CAPTURE(one.lapse, one.value);
    SharedParameters shared{.lapse = one.lapse};
    shared.sure_below = 0.7;
    shared.sure_above = 0.9;
    const auto cells = cells_of(kTwoPeople, one.same_level);
    CHECK(std::abs(HierarchicalLikelihood(cells, one.model, shared).at(place).log_likelihood - one.value) < 1e-6);
    CHECK(std::abs(HierarchicalLikelihood(cells, one.model, shared, 2).at(place).log_likelihood - one.value) < 1e-7);
  }
}

HierarchicalModel graded_model(ResponseModel response = ResponseModel::yes_no) {
  HierarchicalModel model;
  model.response = response;
  model.estimated = SharedForm{}.with(SharedParameter::sure_below).with(SharedParameter::sure_above);
  return model;
}

// As model of one person without spreads: log-likelihood, sigma and its interval, criteria by R 4.2.2, ordinal::clm.
TEST_CASE("of one person it is the ordered probit of same-different with sureness", "[hierarchical][sureness]") {
  const struct {
    std::vector<CategoryRow> rows;
    double log_likelihood, sigma, criteria[3], low, high;
  } cases[] = {{{{0, 0, 0, 20, 12, 6, 2},
                 {0, 0, 100, 8, 7, 6, 3},
                 {0, 0, 200, 5, 6, 7, 6},
                 {0, 0, 300, 2, 4, 8, 10},
                 {0, 0, 400, 1, 2, 6, 15}},
                -164.22586923470814,
                209.87257149681608,
                {0.0459546852020203, 0.8007780473678806, 1.6239592573888086},
                162.48750181775952,
                294.45792567107634},
               {{{0, 0, 0, 14, 6, 3, 1}, {0, 0, 250, 4, 5, 7, 8}},
                -57.74684038906889,
                201.72002363674375,
                {0.23044949989762728, 0.9343734678963671, 1.6848314059178502},
                130.97174219979865,
                430.94427055958994}};
  for (const auto& one : cases) {
    HierarchicalAnalysis analysis(cells_of(one.rows), graded_model());
    const HierarchicalFit& fit = analysis.add_intervals();
    REQUIRE(fit.maximum.converged);
    const SharedParameters& shared = fit.maximum.shared;
    const ConditionMean& found = fit.conditions[0];
    CHECK(std::abs(fit.maximum.log_likelihood - one.log_likelihood) < 1e-6);
    CHECK(std::exp(found.mu) == Approx(one.sigma).epsilon(2e-4));
    CHECK(std::abs(found.criterion - shared.sure_below - one.criteria[0]) < 2e-4);
    CHECK(std::abs(found.criterion - one.criteria[1]) < 2e-4);
    CHECK(std::abs(found.criterion + shared.sure_above - one.criteria[2]) < 2e-4);
    CHECK(std::exp(found.ends.low) == Approx(one.low).epsilon(3e-4));
    CHECK(std::exp(found.ends.high) == Approx(one.high).epsilon(3e-4));
  }
}

TEST_CASE("categories that nobody used are one with their neighbours", "[hierarchical][sureness]") {
  std::vector<HierarchicalCell> cells = cells_of(kTwoPeople), two = cells;
  for (HierarchicalCell& cell : two) cell.sure_positive = cell.sure_negative = 0;
  const HierarchicalFit plain = HierarchicalAnalysis(two, {}).fit();
  SECTION("all sure, or nobody: the likelihood of two answers") {
    for (HierarchicalCell& cell : cells) {
      cell.sure_positive = cell.positive;
      cell.sure_negative = 0;
    }
    HierarchicalAnalysis analysis(cells, graded_model());
    CHECK(analysis.fit().maximum.log_likelihood == Approx(plain.maximum.log_likelihood).margin(1e-9));
    for (const SharedEstimate& one : analysis.shared_estimates()) {
      CHECK(one.status == SharedStatus::not_identified);
      CHECK(std::isnan(one.value));
    }
  }
  SECTION("one side only") {
    for (HierarchicalCell& cell : cells) cell.sure_negative = 0;
    HierarchicalAnalysis analysis(cells, graded_model());
    const std::vector<SharedEstimate> estimates = analysis.shared_estimates();
    REQUIRE(estimates.size() == 2);
    CHECK(estimates[0].status == SharedStatus::not_identified);
    CHECK(estimates[1].status == SharedStatus::ok);
    CHECK(estimates[1].value > 0.1);
    CHECK(estimates[1].ends.low < estimates[1].value);
    CHECK(estimates[1].ends.high > estimates[1].value);
    CHECK(std::isnan(estimates[1].p));
    CHECK(analysis.fit().maximum.shared.sure_below == kInf);
    CHECK(analysis.fit().maximum.log_likelihood < plain.maximum.log_likelihood);
  }
  SECTION("sureness that is told but not asked for changes nothing") {
    CHECK(HierarchicalAnalysis(cells, {}).fit().maximum.log_likelihood ==
          Approx(plain.maximum.log_likelihood).margin(1e-9));
  }
}

TEST_CASE("drawn answers with sureness give back what they were drawn from, and narrower intervals than two answers",
          "[hierarchical][sureness][long]") {
  HierarchicalModel truth;
  truth.shared.sure_below = 0.6;
  truth.shared.sure_above = 1;
  std::vector<HierarchicalCell> cells = drawn_answers(published_questions(20, 1), truth, published_truth(), 31, 0);
  HierarchicalAnalysis graded(cells, graded_model());
  for (HierarchicalCell& cell : cells) cell.sure_positive = cell.sure_negative = 0;
  HierarchicalAnalysis two(cells, {});
  const HierarchicalFit &fit = graded.add_intervals(), &plain = two.add_intervals();
  REQUIRE(fit.maximum.converged);
  CHECK(std::abs(fit.maximum.shared.sure_below - 0.6) < 0.15);
  CHECK(std::abs(fit.maximum.shared.sure_above - 1) < 0.2);
  const ProfileEnds &narrow = fit.conditions[0].ends, &wide = plain.conditions[0].ends;
  CHECK(std::abs(fit.conditions[0].mu - published_truth().mu[0]) < 0.2);
  CHECK(narrow.high - narrow.low < 0.95 * (wide.high - wide.low));
}

TEST_CASE("the independent observer's rates are those of the unbiased likelihood-ratio observer, and of the unit slope",
          "[hierarchical][independent]") {
  for (const double dprime : {0.3, 1.0, 1.7, 3.0, 5.0}) {
    CAPTURE(dprime);
    const double p = normal_cdf(0.5 * dprime), q = normal_cdf(-0.5 * dprime);
    const auto rate = [&](double level, double k) {
      return std::exp(log_rates(ResponseModel::independent, level, 0, k, 0).positive);
    };
    CHECK(rate(dprime, 0) == Approx(p * p + q * q).epsilon(1e-5));
    CHECK(rate(-dprime, 0) == Approx(2 * p * q).epsilon(1e-5));
    for (const double k : {-0.8, 0.4})
      CHECK(unit_slope_dprime(normal_quantile(rate(dprime, k)) - normal_quantile(rate(-dprime, k))) ==
            Approx(dprime).epsilon(1e-9));
  }
}

TEST_CASE("answers of the independent observer give back what they were drawn from", "[hierarchical][independent]") {
  std::vector<HierarchicalCell> questions;
  for (int p = 0; p < 25; ++p)
    for (int c = 0; c < 2; ++c)
      for (const double level : {-200.0, -300.0, -400.0, 200.0, 300.0, 400.0})
        questions.push_back({p, c, level, 0, 12});
  HierarchicalModel model;
  model.response = ResponseModel::independent;
  HierarchicalPlace truth = published_truth();
  truth.kappa.assign(3, 0.2);
  const auto cells = drawn_answers(questions, model, truth, 33, 0);
  HierarchicalAnalysis analysis(cells, model);
  const HierarchicalFit& fit = analysis.add_intervals();
  REQUIRE(fit.maximum.converged);
  for (std::size_t c = 0; c < 2; ++c) {
    CHECK(std::abs(fit.conditions[c].mu - truth.mu[c]) < 0.2);
    CHECK(std::abs(fit.conditions[c].criterion - 0.2) < 0.2);
    CHECK(fit.conditions[c].ends.low < truth.mu[c]);
    CHECK(fit.conditions[c].ends.high > truth.mu[c]);
  }
  CHECK(std::abs(fit.maximum.place.tu - truth.tu) < 0.12);
  HierarchicalLikelihood fine(cells, model.response, {}, 2);
  CHECK(std::abs(fine.at(fit.maximum.place).log_likelihood - fit.maximum.log_likelihood) < 1e-6);
}

}  // namespace
}  // namespace jnd
