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

}  // namespace
}  // namespace jnd
