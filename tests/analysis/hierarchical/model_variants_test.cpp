// The hierarchical model with more in it than a mean and a spread.
#include "analysis/hierarchical/model_variants.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "analysis/detection/independent_observation.h"
#include "analysis/hierarchical/hierarchical_fit.h"
#include "analysis/hierarchical/shared_parameters.h"
#include "analysis/numerics/normal.h"
#include "tests/analysis/hierarchical/hierarchical_fixtures.h"
#include "tests/catch.h"

namespace jnd {
namespace {

// The hierarchical model with one thing more in it: each variant is that model of the answers it needs.

using testing::published_study;

// Five people; half of every cell's answers come in the second half, with more "different" among them.
std::vector<HierarchicalCell> drifting_study() {
  std::vector<HierarchicalCell> cells;
  for (const HierarchicalCell& cell : published_study(5, 3)) {
    HierarchicalCell first = cell, second = cell;
    const double trials = cell.positive + cell.negative, more = std::min(cell.positive, trials / 2);
    second.second_half = true;
    second.positive = more;
    second.negative = trials / 2 - more;
    first.positive = cell.positive - more;
    first.negative = trials / 2 - first.positive;
    cells.push_back(first);
    cells.push_back(second);
  }
  return cells;
}

const ModelVariant& variant_of(const std::vector<ModelVariant>& variants, VariantKind kind) {
  const auto found =
      std::find_if(variants.begin(), variants.end(), [kind](const ModelVariant& one) { return one.kind == kind; });
  if (found == variants.end()) throw std::runtime_error("no such variant");
  return *found;
}

void check_equal(const ModelVariant& found, const std::vector<HierarchicalCell>& cells, const SharedForm& estimated) {
  HierarchicalModel model;
  model.estimated = estimated;
  HierarchicalAnalysis analysis(cells, model);
  const std::vector<SharedEstimate> shared = analysis.shared_estimates();
  REQUIRE(found.shared.size() == shared.size());
  for (std::size_t i = 0; i < shared.size(); ++i) {
    CHECK(found.shared[i].parameter == shared[i].parameter);
    CHECK(found.shared[i].status == shared[i].status);
    CHECK(found.shared[i].value == Approx(shared[i].value).margin(1e-9));
    CHECK(found.shared[i].p == Approx(shared[i].p).margin(1e-9));
  }
  REQUIRE(found.conditions.size() == 3);
  const HierarchicalFit& fit = analysis.add_intervals();
  for (std::size_t c = 0; c < 3; ++c) CHECK(found.conditions[c].ends.high == Approx(fit.conditions[c].ends.high));
}

TEST_CASE("every variant is a model of its own", "[analysis][hierarchical][long]") {
  const std::vector<HierarchicalCell> halves = drifting_study();
  const std::vector<HierarchicalCell> plain = without_halves_and_sureness(halves);
  CHECK(std::none_of(plain.begin(), plain.end(), [](const HierarchicalCell& cell) { return cell.second_half; }));
  const std::vector<ModelVariant> variants = model_variants(halves, {});
  REQUIRE(variants.size() == 3);
  const SharedForm none;
  check_equal(variant_of(variants, VariantKind::overdispersion), plain, none.with(SharedParameter::overdispersion));
  check_equal(variant_of(variants, VariantKind::drift), halves,
              none.with(SharedParameter::drift_ln_s).with(SharedParameter::drift_criterion));
  CHECK(variant_of(variants, VariantKind::drift).shared[1].p < 0.001);
  CHECK(variant_of(variants, VariantKind::lapse).shared[0].parameter == SharedParameter::lapse);
}

TEST_CASE("what these answers cannot tell, or the model has no place for, is left out or says so",
          "[analysis][hierarchical]") {
  std::vector<HierarchicalCell> cells = published_study(4, 1);
  std::erase_if(cells, [](const HierarchicalCell& cell) { return cell.level == 200 || cell.level == 300; });
  for (HierarchicalCell& cell : cells) {  // of a PSE that is taken as known, every answer counts half
    cell.positive /= 2;
    cell.negative /= 2;
  }
  HierarchicalModel model;
  model.tw = false;
  cells.front().positive += 0.5;
  const std::vector<ModelVariant> variants = model_variants(cells, model);
  REQUIRE(variants.size() == 2);  // no over-dispersion
  for (const ModelVariant& one : variants) {
    REQUIRE(one.shared.size() == 1);
    CHECK(one.shared[0].status == SharedStatus::not_identified);
    CHECK(one.conditions.empty());
  }
  CHECK(variants[0].shared[0].parameter == SharedParameter::drift_ln_s);
  CHECK(variants[1].shared[0].parameter == SharedParameter::lapse);
  for (HierarchicalCell& cell : cells) cell.sure_positive = cell.positive / 2;
  const std::vector<ModelVariant> graded = model_variants(cells, model);
  REQUIRE(graded.size() == 3);
  CHECK(graded[2].kind == VariantKind::sureness);
  CHECK(graded[2].shared[0].status == SharedStatus::not_identified);  // nobody was sure of "same"
  CHECK(graded[2].shared[1].status == SharedStatus::ok);
}

// Answers in four categories of sureness, and the observer of independent observations.

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

// Lapses, over-dispersion and drift, the same for everybody: the likelihood by brute force, known truths that come back,
// and what cannot be told.

// Both halves of every cell of the published design, several times as many trials.
std::vector<HierarchicalCell> halved_questions(int participants, int times) {
  std::vector<HierarchicalCell> cells;
  for (const bool second_half : {false, true})
    for (HierarchicalCell cell : published_questions(participants, 1)) {
      cell.negative *= times / 2.0;
      cell.second_half = second_half;
      cells.push_back(cell);
    }
  return cells;
}

HierarchicalPlace one_condition_truth() {
  HierarchicalPlace truth = published_truth();
  truth.mu.resize(1);
  truth.kappa.resize(1);
  return truth;
}

// ln of the beta-binomial probability, with gamma functions and without the binomial coefficient.
double beta_binomial(double y, double n, double p, double r) {
  if (r == 0) return y * std::log(p) + (n - y) * std::log1p(-p);
  const double a = p * (1 - r) / r, b = (1 - p) * (1 - r) / r;
  return std::lgamma(y + a) + std::lgamma(n - y + b) - std::lgamma(n + a + b) + std::lgamma(a + b) - std::lgamma(a) -
         std::lgamma(b);
}

// Of one person in one condition, by the midpoint rule over u (v is 0) and w.
double by_brute_force(const std::vector<HierarchicalCell>& cells, const SharedParameters& shared,
                      const HierarchicalPlace& place) {
  constexpr int kSteps = 140;
  constexpr double kReach = 7, kWidth = 2 * kReach / kSteps;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i)
    for (int j = 0; j < kSteps; ++j) {
      const double a = -kReach + (i + 0.5) * kWidth, b = -kReach + (j + 0.5) * kWidth;
      double log_value = -(a * a + b * b) / 2 - std::log(2 * 3.141592653589793);
      for (const HierarchicalCell& cell : cells) {
        const double half = cell.second_half ? 0.5 : -0.5;
        const double s = std::exp(place.mu[0] + place.tu * a + half * shared.drift_ln_s),
                     k = place.kappa[0] + place.tw * b + half * shared.drift_criterion;
        const double rate = shared.lapse / 2 + (1 - shared.lapse) * normal_cdf(cell.level / s - k);
        const double p = std::clamp(rate, 1e-15, 1 - 1e-15);
        log_value += beta_binomial(cell.positive, cell.positive + cell.negative, p, shared.overdispersion);
      }
      sum += std::exp(log_value) * kWidth * kWidth;
    }
  return std::log(sum);
}

TEST_CASE("the likelihood with lapses, over-dispersion and drift by brute force", "[hierarchical]") {
  const std::vector<HierarchicalCell> cells = {{0, 0, 0, 4, 14},        {0, 0, 200, 3, 3},
                                               {0, 0, 400, 5, 1},       {0, 0, 0, 7, 11, true},
                                               {0, 0, 200, 0, 6, true}, {0, 0, 400, 6, 0, true}};
  HierarchicalPlace place = one_condition_truth();
  place.tv = 0;
  HierarchicalLikelihood likelihood(cells, ResponseModel::yes_no, {});
  double before = 0;
  for (const SharedParameters& shared :
       {SharedParameters{},
        {.lapse = 0.05},
        {.overdispersion = 0.15},
        {.overdispersion = 1e-7},
        {.overdispersion = 0.8},
        {.drift_ln_s = -0.4, .drift_criterion = 0.3},
        {.lapse = 0.03, .overdispersion = 0.1, .drift_ln_s = 0.5, .drift_criterion = -0.2},
        SharedParameters{}}) {
    CAPTURE(shared.lapse, shared.overdispersion, shared.drift_ln_s, shared.drift_criterion);
    likelihood.set_shared(shared);
    const double value = likelihood.at(place).log_likelihood;
    const bool hardly = shared.overdispersion == 1e-7;  // gamma functions lose digits there
    CHECK(std::abs(value - by_brute_force(cells, hardly ? SharedParameters{} : shared, place)) <
          (hardly ? 1e-4 : 1e-6));
    if (shared == SharedParameters{} && before != 0) CHECK(std::abs(value - before) < 1e-6);
    if (before == 0) before = value;
  }
}

SharedEstimate only(const std::vector<SharedEstimate>& estimates) {
  REQUIRE(estimates.size() == 1);
  return estimates.front();
}

TEST_CASE("answers that are more alike than independent ones: the truth comes back, and the group is known less well",
          "[hierarchical][long]") {
  HierarchicalModel truth, model;
  truth.shared.overdispersion = 0.2;
  model.tv = false;
  const auto cells = drawn_answers(published_questions(16, 1), truth, one_condition_truth(), 31, 0);
  HierarchicalAnalysis plain(cells, model);
  const HierarchicalFit without = plain.add_intervals();
  model.estimated = model.estimated.with(SharedParameter::overdispersion);
  HierarchicalAnalysis analysis(cells, model);
  const HierarchicalFit with = analysis.add_intervals();
  const SharedEstimate one = only(analysis.shared_estimates());
  CHECK(with.maximum.converged);
  CHECK(one.status == SharedStatus::ok);
  CHECK(one.ends.low < 0.2);
  CHECK(one.ends.high > 0.2);
  CHECK(one.ends.low > 0);
  CHECK(one.lr == Approx(2 * (with.maximum.log_likelihood - without.maximum.log_likelihood)).margin(1e-4));
  CHECK(one.p < 0.001);
  const ProfileEnds wide = with.conditions[0].ends, narrow = without.conditions[0].ends;
  CHECK(wide.high - wide.low > 1.03 * (narrow.high - narrow.low));
  // Nothing beside it is likelier.
  double best = -kInf;
  for (int i = -1; i <= 1; ++i) {
    HierarchicalModel held = model;
    held.estimated = {};
    held.shared.overdispersion = one.value + 0.01 * i;
    const double value = HierarchicalAnalysis(cells, held).fit().maximum.log_likelihood;
    if (i == 0) CHECK(std::abs(value - with.maximum.log_likelihood) < 1e-6);
    best = std::max(best, value);
  }
  CHECK(best <= with.maximum.log_likelihood + 1e-6);
}

TEST_CASE("lapses that are the same for everybody come back", "[hierarchical]") {
  HierarchicalModel truth, model;
  truth.shared.lapse = 0.12;
  model.tv = false;
  std::vector<HierarchicalCell> questions;
  for (HierarchicalCell cell : published_questions(10, 1)) {
    cell.negative *= 4;
    questions.push_back(cell);
    if (cell.level == 400) {
      cell.level = 1600;
      questions.push_back(cell);
    }
  }
  const auto cells = drawn_answers(questions, truth, one_condition_truth(), 32, 0);
  model.estimated = model.estimated.with(SharedParameter::lapse);
  HierarchicalAnalysis analysis(cells, model);
  const SharedEstimate one = only(analysis.shared_estimates());
  CHECK(one.status == SharedStatus::ok);
  CHECK(one.value == Approx(0.12).margin(0.04));
  CHECK(one.ends.low < one.value);
  CHECK(one.ends.high > one.value);
  CHECK(one.p < 0.01);
}

TEST_CASE("a drift between the halves comes back, of the JND and of the criterion", "[hierarchical]") {
  HierarchicalModel truth, model;
  truth.shared.drift_ln_s = -0.4;
  truth.shared.drift_criterion = 0.25;
  model.tv = false;
  const auto cells = drawn_answers(halved_questions(8, 6), truth, one_condition_truth(), 33, 0);
  model.estimated = model.estimated.with(SharedParameter::drift_ln_s).with(SharedParameter::drift_criterion);
  const HierarchicalFit both = HierarchicalAnalysis(cells, model).fit();
  CHECK(both.maximum.converged);
  CHECK(both.maximum.shared.drift_ln_s == Approx(-0.4).margin(0.25));
  CHECK(both.maximum.shared.drift_criterion == Approx(0.25).margin(0.2));
  // Alone, with its interval; without the other it is another model, which is less likely.
  model.estimated = model.estimated.with(SharedParameter::drift_criterion, false);
  HierarchicalAnalysis alone(cells, model);
  CHECK(alone.fit().maximum.log_likelihood < both.maximum.log_likelihood);
  const SharedEstimate one = only(alone.shared_estimates());
  CHECK(one.status == SharedStatus::ok);
  CHECK(one.ends.low < one.value);
  CHECK(one.ends.high > one.value);
  CHECK((one.p < 0.05) == (one.ends.low > 0 || one.ends.high < 0));
}

TEST_CASE("what is the same for everybody has a status where it is 0, or cannot be told", "[hierarchical]") {
  HierarchicalModel model;
  model.tv = false;
  const auto estimated = [&model](SharedParameter which, const std::vector<HierarchicalCell>& cells) {
    HierarchicalModel one = model;
    one.estimated = one.estimated.with(which);
    return only(HierarchicalAnalysis(cells, one).shared_estimates());
  };
  SECTION("answers less spread than independent ones: over-dispersion 0, and its test says nothing") {
    std::vector<HierarchicalCell> cells;
    for (int p = 0; p < 8; ++p)
      for (const auto& [level, positive] : {std::pair{0.0, 4.0}, {200.0, 3.0}, {400.0, 5.0}})
        cells.push_back({p, 0, level, positive, (level == 0 ? 18.0 : 6.0) - positive});
    const SharedEstimate one = estimated(SharedParameter::overdispersion, cells);
    CHECK(one.status == SharedStatus::zero);
    CHECK(one.value == 0);
    CHECK(one.ends.low == 0);
    CHECK(one.ends.high > 0);
    CHECK(one.p == 1);
  }
  SECTION("one trial each, two levels, or one half only") {
    std::vector<HierarchicalCell> cells;
    for (int p = 0; p < 12; ++p)
      for (const double level : {0.0, 300.0}) cells.push_back({p, 0, level, (p + (level > 0)) % 3 > 0 ? 1.0 : 0.0, 0});
    for (HierarchicalCell& cell : cells) cell.negative = 1 - cell.positive;
    for (const SharedParameter which : kSharedParameters) {
      const SharedEstimate one = estimated(which, cells);
      CHECK(one.status == SharedStatus::not_identified);
      CHECK(std::isnan(one.value));
      CHECK(std::isnan(one.p));
    }
  }
}

}  // namespace
}  // namespace jnd
