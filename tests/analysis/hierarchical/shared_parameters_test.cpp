// Lapses, over-dispersion and drift, the same for everybody: the likelihood by brute force, known truths that come back,
// and what cannot be told.
#include "analysis/hierarchical/shared_parameters.h"

#include <algorithm>
#include <cmath>

#include "analysis/hierarchical/hierarchical_fit.h"
#include "analysis/numerics/normal.h"
#include "tests/analysis/hierarchical/hierarchical_fixtures.h"
#include "tests/catch.h"

namespace jnd {
namespace {

using namespace jnd::testing;

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
