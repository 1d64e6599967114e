// The posterior predictive check: answers of the model pass, others do not, and what cannot be compared is named.
#include "analysis/hierarchical/predictive_check.h"

#include <cmath>

#include "tests/analysis/hierarchical/hierarchical_fixtures.h"
#include "tests/catch.h"

namespace jnd {
namespace {

using namespace jnd::testing;

PredictiveCheck check_of(const std::vector<HierarchicalCell>& cells, int draws = 200) {
  const HierarchicalAnalysis analysis(cells, {});
  return predictive_check(cells, {}, analysis.fit().maximum.place, draws, 1);
}

// Every answer is given twice, so that those of a person at a level hang together.
std::vector<HierarchicalCell> doubled(std::vector<HierarchicalCell> cells) {
  for (HierarchicalCell& cell : cells) {
    cell.positive *= 2;
    cell.negative *= 2;
  }
  return cells;
}

TEST_CASE("answers of the model look like those that it draws", "[hierarchical]") {
  const std::vector<HierarchicalCell> cells = published_study(12, 30);
  const PredictiveCheck check = check_of(cells);
  REQUIRE(check.rows.size() == 12);
  CHECK(check.bands() == 24);
  CHECK(check.outside() <= 3);
  CHECK(check.bands_fit());
  CHECK(check.scatter_fits());
  CHECK((check.bands_fit() && check.scatter_fits()));
  // 144 counts, each with a discrepancy of 1 at its own rate.
  CHECK(std::abs(check.drawn - 144) < 25);
  double positive = 0, trials = 0;
  for (const HierarchicalCell& cell : cells)
    if (cell.condition == 1 && cell.level == 300) {
      positive += cell.positive;
      trials += cell.positive + cell.negative;
    }
  const PredictiveRow& row = check.rows[6];
  CHECK(row.condition == 1);
  CHECK(row.level == 300);
  CHECK(row.participants == 12);
  CHECK(row.trials == trials);
  CHECK(row.share.observed == Approx(positive / trials));
  CHECK(row.share.low < row.share.observed);
  CHECK(row.share.high > row.share.observed);
  // The band is hardly wider than that of so many answers with rates that are known.
  const double binomial = std::sqrt(row.share.observed * (1 - row.share.observed) / trials);
  CHECK(row.share.high - row.share.low > 3 * binomial);
  CHECK(row.share.high - row.share.low < 6 * binomial);
}

TEST_CASE("answers that hang together scatter more than drawn ones, and too regular ones less", "[hierarchical]") {
  std::vector<HierarchicalCell> questions = published_questions(12);
  for (HierarchicalCell& cell : questions) cell.negative /= 2;
  const PredictiveCheck paired = check_of(doubled(drawn_answers(questions, {}, published_truth(), 5, 1)));
  CHECK(paired.p < 0.02);
  CHECK_FALSE(paired.scatter_fits());
  CHECK_FALSE((paired.bands_fit() && paired.scatter_fits()));

  std::vector<HierarchicalCell> regular = published_questions(12);
  for (HierarchicalCell& cell : regular) {  // everybody as near to one curve as counts can be
    const double trials = cell.positive + cell.negative;
    cell.positive = std::round(trials * std::exp(log_rates(ResponseModel::yes_no, cell.level, 5.5, 0.75, 0).positive));
    cell.negative = trials - cell.positive;
  }
  const PredictiveCheck alike = check_of(regular);
  CHECK(alike.p > 0.98);
  CHECK_FALSE(alike.scatter_fits());
  CHECK((!alike.scatter_fits() && alike.p > 0.5));
}

TEST_CASE("a level at which people answer otherwise lies outside its band", "[hierarchical]") {
  std::vector<HierarchicalCell> cells = published_study(12, 31);
  for (HierarchicalCell& cell : cells)
    if (cell.condition == 0 && cell.level == 300) std::swap(cell.positive, cell.negative);
  const PredictiveCheck check = check_of(cells);
  CHECK(check.rows[2].share.status == BandStatus::below);
  CHECK(check.rows[2].share.observed < check.rows[2].share.low);
}

TEST_CASE("what a check has nothing to compare with is named, and its numbers are its own", "[hierarchical]") {
  SECTION("one participant") {
    const PredictiveCheck check = check_of(published_study(1, 4), 50);
    for (const PredictiveRow& row : check.rows) {
      CHECK(row.between.status == BandStatus::one_person);
      CHECK(std::isnan(row.between.low));
      CHECK(row.share.status != BandStatus::one_person);
    }
    CHECK(check.bands() == 12);
  }
  SECTION("levels without trials have no row, cells of one level are one, and a seed is a seed") {
    std::vector<HierarchicalCell> cells = published_study(4, 6), halves;
    for (HierarchicalCell cell : cells) {
      if (cell.level == 400) cell.positive = cell.negative = 0;
      halves.push_back({cell.participant, cell.condition, cell.level, cell.positive, 0});
      halves.push_back({cell.participant, cell.condition, cell.level, 0, cell.negative});
    }
    const PredictiveCheck one = check_of(halves, 50), two = check_of(halves, 50);
    CHECK(one.rows.size() == 9);
    CHECK(one.rows[0].participants == 4);
    CHECK(one.p == two.p);
    CHECK(one.rows[3].share.low == two.rows[3].share.low);
    CHECK(one.draws == 50);
  }
}

TEST_CASE("so many bands lie outside by chance", "[hierarchical]") {
  PredictiveCheck check;
  PredictiveBand inside{0.5, 0.4, 0.6, BandStatus::inside};
  for (int i = 0; i < 12; ++i) check.rows.push_back({0, 0, 2, 10, inside, inside});
  CHECK(check.outside_by_chance() == 3);  // P(more than 3 of 24) = 0.030, P(more than 2) = 0.116
  check.rows[0].share.status = check.rows[1].share.status = check.rows[2].between.status = BandStatus::above;
  CHECK(check.outside() == 3);
  CHECK(check.bands_fit());
  check.rows[3].between.status = BandStatus::below;
  CHECK_FALSE(check.bands_fit());
}

}  // namespace
}  // namespace jnd
