// Where one person lies by their answers and the group.
#include "analysis/hierarchical/person_mode.h"

#include <cmath>

#include "tests/catch.h"

namespace jnd {
namespace {

double log_posterior(const std::vector<PersonCell>& cells, ResponseModel model, const GroupSpread& spread, double u,
                     double w) {
  const double a = u / spread.tu, b = w / spread.tw, rho = spread.rho;
  double value = -(a * a - 2 * rho * a * b + b * b) / (2 * (1 - rho * rho));
  for (const PersonCell& cell : cells)
    for (const PersonCell::Counted& one : cell.answers) {
      const LogRates rates = log_rates(model, one.level, cell.mu + u, cell.kappa + w, 0.02);
      value += one.counts.positive * rates.positive + one.counts.negative * rates.negative;
    }
  return value;
}

TEST_CASE("a person lies where the posterior is largest, and knows how narrow it is", "[hierarchical]") {
  const std::vector<PersonCell> cells = {{{{0, 3, 15}, {200, 2, 4}, {400, 6, 0}}, std::log(250), 0.7},
                                         {{{0, 5, 13}, {300, 3, 3}}, std::log(300), 0.8}};
  for (const double rho : {0.0, 0.7}) {
    const GroupSpread spread = {0.4, 0.3, rho};
    const PersonMode mode = person_mode(cells, ResponseModel::yes_no, {.lapse = 0.02}, spread);
    const double best = log_posterior(cells, ResponseModel::yes_no, spread, mode.u, mode.w);
    for (const double step : {-0.05, 0.05}) {
      CHECK(log_posterior(cells, ResponseModel::yes_no, spread, mode.u + step, mode.w) < best);
      CHECK(log_posterior(cells, ResponseModel::yes_no, spread, mode.u, mode.w + step) < best);
    }
    CHECK(mode.information_u > 1);
    CHECK(mode.information_w > 1);
  }
}

TEST_CASE("without answers, or without a spread, a person lies where the group does", "[hierarchical]") {
  const PersonMode nobody =
      person_mode(std::vector<PersonCell>{{{}, 5, 0.7}}, ResponseModel::yes_no, {}, {0.3, 0.3, 0});
  CHECK(std::abs(nobody.u) < 1e-6);
  CHECK(nobody.information_u < 1e-9);
  const std::vector<PersonCell> cells = {{{{0, 3, 15}, {200, 2, 4}, {400, 6, 0}}, 5, 0.7}};
  const PersonMode held = person_mode(cells, ResponseModel::yes_no, {}, {0, 0.3, 0});
  CHECK(held.u == 0);
  CHECK(held.w != 0);
}

TEST_CASE("what v adds between a person and their answers leaves less to be known of u", "[hierarchical]") {
  std::vector<PersonCell> cells = {{{{0, 300, 1500}, {200, 200, 400}, {400, 600, 0}}, std::log(250), 0.7}};
  const auto known = [&](double tv) {
    cells.front().tv = tv;
    return person_mode(cells, ResponseModel::yes_no, {}, {0.3, 0.3, 0}).information_u;
  };
  CHECK(known(0) > 400);
  CHECK(known(0.2) < 1 / (0.2 * 0.2));
}

}  // namespace
}  // namespace jnd
