// Persons of the hierarchical model: modes, draws and predictive checks.
#include <cmath>

#include "analysis/hierarchical/person_mode.h"
#include "analysis/hierarchical/predictive_check.h"
#include "tests/analysis/hierarchical/hierarchical_fixtures.h"
#include "tests/catch.h"

namespace jnd {
namespace {

// Where one person lies by their answers and the group.

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

// Draws of people against the moments of their posteriors, and where there is nothing to draw.

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

// The posterior predictive check: answers of the model pass, others do not, and what cannot be compared is named.

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
