// The exact distribution of the JND against every combination of counts put through least_squares_jnd().
#include "analysis/precision/slope_distribution.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "analysis/numerics/special_values.h"
#include "analysis/precision/cell_distribution.h"
#include "analysis/thresholds/jnd.h"
#include "tests/catch.h"

namespace jnd {
namespace {

struct Outcome {
  Counts counts;
  double probability = 0;
};

double binomial_by_gamma(int k, int n, double p) {
  return std::round(std::exp(std::lgamma(n + 1) - std::lgamma(k + 1) - std::lgamma(n - k + 1))) * std::pow(p, k) *
         std::pow(1 - p, n - k);
}

std::vector<Outcome> outcomes(const CellProbabilities& cell) {
  std::vector<Outcome> all;
  for (int n_same = 0; n_same <= cell.trials; ++n_same) {
    const bool balanced = cell.class_sizes == ClassSizes::balanced;
    if (balanced && n_same != cell.trials / 2) continue;
    const int n_diff = cell.trials - n_same;
    for (int hits = 0; hits <= n_diff; ++hits)
      for (int false_alarms = 0; false_alarms <= n_same; ++false_alarms)
        all.push_back(
            {{n_diff, hits, n_same, false_alarms},
             (balanced ? 1 : binomial_by_gamma(n_same, cell.trials, 0.5)) * binomial_by_gamma(hits, n_diff, cell.hit) *
                 binomial_by_gamma(false_alarms, n_same, cell.false_alarm)});
  }
  return all;
}

struct Reference {
  JndStatusShares status;
  std::vector<std::pair<double, double>> jnds;  // with their probability; of those with information
  double mean = 0;
};

Reference reference(const CountsDesign& design, double jnd) {
  std::vector<std::vector<Outcome>> cells;
  for (const double difference : design.differences)
    cells.push_back(outcomes(cell_probabilities(design, difference, jnd)));
  Reference result;
  std::vector<std::size_t> at(cells.size(), 0);
  for (bool more = true; more;) {
    std::vector<SeriesCounts> series;
    double probability = 1;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      series.push_back({design.differences[i], cells[i][at[i]].counts});
      probability *= cells[i][at[i]].probability;
    }
    const JndEstimate estimate = least_squares_jnd(series, 900, design.correction);
    switch (estimate.status) {
      case JndStatus::ok:
        result.status.ok += probability;
        result.mean += probability * estimate.jnd;
        result.jnds.emplace_back(estimate.jnd, probability);
        break;
      case JndStatus::no_sensitivity:
        result.status.no_sensitivity += probability;
        result.jnds.emplace_back(kInf, probability);
        break;
      case JndStatus::ceiling:
        result.status.ceiling += probability;
        result.jnds.emplace_back(0, probability);
        break;
      case JndStatus::no_information:
        result.status.no_information += probability;
        break;
    }
    more = false;
    for (std::size_t i = 0; i < cells.size() && !more; ++i) {
      more = ++at[i] < cells[i].size();
      if (!more) at[i] = 0;
    }
  }
  result.mean /= result.status.ok;
  std::sort(result.jnds.begin(), result.jnds.end());
  return result;
}

SlopeDistribution exact(const CountsDesign& design, double jnd) {
  std::vector<CellDistribution> cells;
  for (const double difference : design.differences)
    cells.push_back(cell_distribution(cell_probabilities(design, difference, jnd)));
  REQUIRE(SlopeDistribution::feasible(cells));
  return {cells, design.differences};
}

// The share of the reference's JNDs below and up to a value, of those with information.
double share_up_to(const Reference& reference, double value) {
  double sum = 0;
  for (const auto& [jnd, probability] : reference.jnds)
    if (jnd <= value) sum += probability;
  return sum / (1 - reference.status.no_information);
}

void compare(const CountsDesign& design, double jnd) {
  const Reference wanted = reference(design, jnd);
  const SlopeDistribution found = exact(design, jnd);
  CAPTURE(jnd, design.trials, to_string(design.correction), design.class_sizes == ClassSizes::balanced);
  CHECK(found.status().ok == Approx(wanted.status.ok).margin(1e-12));
  CHECK(found.status().no_sensitivity == Approx(wanted.status.no_sensitivity).margin(1e-12));
  CHECK(found.status().ceiling == Approx(wanted.status.ceiling).margin(1e-12));
  CHECK(found.status().no_information == Approx(wanted.status.no_information).margin(1e-12));
  if (wanted.status.ok > 1e-12) CHECK(found.mean_jnd() == Approx(wanted.mean).epsilon(1e-9));
  double within = 0;
  for (const auto& [value, probability] : wanted.jnds)
    if (value >= 150 && value <= 450) within += probability;
  CHECK(found.jnd_within(150, 450) == Approx(within).margin(1e-12));
  for (const double share : {0.025, 0.1587, 0.5, 0.81, 0.95}) {
    const double quantile = found.jnd_quantile(share);
    CAPTURE(share, quantile);
    CHECK(std::isnan(quantile) == wanted.jnds.empty());
    if (wanted.jnds.empty()) continue;
    // At the quantile the share is reached, below it not: a step of the distribution.
    CHECK(share_up_to(wanted, quantile * (1 + 1e-9)) >= share - 1e-12);
    const double below = std::isinf(quantile) ? std::numeric_limits<double>::max() : quantile * (1 - 1e-9);
    if (quantile > 0) CHECK(share_up_to(wanted, below) < share + 1e-12);
  }
}

TEST_CASE("exact JND distribution: every combination of counts, one by one", "[analysis]") {
  for (const ClassSizes sizes : {ClassSizes::random, ClassSizes::balanced}) {
    for (const Correction correction : {Correction::none, Correction::loglinear, Correction::half}) {
      for (const int trials : {1, 2, 4}) {
        CountsDesign design;
        design.differences = {400, 200};
        design.trials = trials;
        design.class_sizes = sizes;
        design.correction = correction;
        for (const double jnd : {100.0, 283.5, 5000.0}) compare(design, jnd);
      }
    }
  }
}

TEST_CASE("exact JND distribution of one and of three series", "[analysis]") {
  CountsDesign design;
  design.differences = {500};
  design.trials = 8;
  compare(design, 225);
  design.differences = {400, 300, 200};
  design.trials = 4;
  compare(design, 208.5);
  design.criterion.kind = CriterionRule::Kind::common;
  design.criterion.common = 150;
  compare(design, 208.5);
  design.differences = {300, 300};  // equal differences: sums coincide
  compare(design, 350);
}

TEST_CASE("thresholds far below and far above the differences", "[analysis]") {
  CountsDesign design;
  design.differences = {400, 300, 200};
  design.class_sizes = ClassSizes::balanced;
  // Everything noticed for certain: the floor of 12 trials, and nothing else.
  const SlopeDistribution tiny = exact(design, 1e-3);
  CHECK(tiny.status().ok == Approx(1).epsilon(1e-12));
  CHECK(tiny.jnd_quantile(0.01) == Approx(109.955907320307).epsilon(1e-9));
  CHECK(tiny.jnd_quantile(0.99) == Approx(109.955907320307).epsilon(1e-9));
  CHECK(tiny.mean_jnd() == Approx(109.955907320307).epsilon(1e-9));
  // Nothing noticed: as many slopes above 0 as below.
  const SlopeDistribution huge = exact(design, 1e9);
  CHECK(huge.status().ok < 0.5);
  CHECK(huge.status().ok > 0.45);
  CHECK(std::isinf(huge.jnd_quantile(0.5)));
  CHECK(huge.status().ok + huge.status().no_sensitivity + huge.status().no_information == Approx(1).epsilon(1e-12));
}

TEST_CASE("too many combinations are not enumerated", "[analysis]") {
  CountsDesign design;
  design.differences = {400, 300, 200};
  design.trials = 40;
  std::vector<CellDistribution> cells;
  for (const double difference : design.differences)
    cells.push_back(cell_distribution(cell_probabilities(design, difference, 300)));
  CHECK_FALSE(SlopeDistribution::feasible(cells));
  CHECK(SlopeDistribution::feasible(std::vector<CellDistribution>(1, cells[0])));
}

}  // namespace
}  // namespace jnd
