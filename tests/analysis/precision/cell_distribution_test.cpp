// Exact distributions: of a cell, and of the JND.
#include "analysis/precision/cell_distribution.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "analysis/detection/yes_no.h"
#include "analysis/numerics/binomial.h"
#include "analysis/numerics/special_values.h"
#include "analysis/precision/slope_distribution.h"
#include "analysis/thresholds/jnd.h"
#include "tests/catch.h"

namespace jnd {
namespace {

// What a cell can come to: probabilities of all outcomes, and of the ones that make d' doubtful.

CellProbabilities model(int trials, ClassSizes sizes, Correction correction, double hit = 0.8,
                        double false_alarm = 0.3) {
  CellProbabilities cell;
  cell.hit = hit;
  cell.false_alarm = false_alarm;
  cell.trials = trials;
  cell.class_sizes = sizes;
  cell.correction = correction;
  return cell;
}

double choose(int n, int k) {
  return std::round(std::exp(std::lgamma(n + 1) - std::lgamma(k + 1) - std::lgamma(n - k + 1)));
}

double binomial(int k, int n, double p) {
  return choose(n, k) * std::pow(p, k) * std::pow(1 - p, n - k);
}

// Calls with all counts of a cell and their probability, by the textbook.
template <typename Call>
void for_all_counts(const CellProbabilities& cell, Call call) {
  for (int n_same = 0; n_same <= cell.trials; ++n_same) {
    const int n_diff = cell.trials - n_same;
    if (cell.class_sizes == ClassSizes::balanced && n_same != cell.trials / 2) continue;
    const double sizes = cell.class_sizes == ClassSizes::balanced ? 1 : binomial(n_same, cell.trials, 0.5);
    for (int hits = 0; hits <= n_diff; ++hits)
      for (int false_alarms = 0; false_alarms <= n_same; ++false_alarms)
        call(Counts{n_diff, hits, n_same, false_alarms},
             sizes * binomial(hits, n_diff, cell.hit) * binomial(false_alarms, n_same, cell.false_alarm));
  }
}

double total(const CellDistribution& cell) {
  double sum = cell.missing + cell.plus_infinity + cell.minus_infinity + cell.undefined;
  for (const CellState& state : cell.states) sum += state.probability;
  return sum;
}

TEST_CASE("binomial tables agree with the formula and add up to 1", "[analysis]") {
  for (const int n : {0, 1, 2, 7, 12, 40}) {
    for (const double p : {0.0, 1e-6, 0.2, 0.5, 0.83, 1.0}) {
      const BinomialTable table = binomial_table(n, p);
      double sum = 0;
      for (std::size_t i = 0; i < table.probability.size(); ++i) {
        const int k = table.first + static_cast<int>(i);
        CHECK(k >= 0);
        CHECK(k <= n);
        CHECK(table.probability[i] == Approx(binomial(k, n, p)).epsilon(1e-10));
        sum += table.probability[i];
      }
      CHECK(sum == Approx(1).epsilon(1e-14));
    }
  }
  // Far more trials than factorials in double precision allow: mean n p and variance n p (1 - p).
  const BinomialTable large = binomial_table(2000, 0.3);
  double mean = 0, squares = 0;
  for (std::size_t i = 0; i < large.probability.size(); ++i) {
    const double k = large.first + static_cast<double>(i);
    mean += k * large.probability[i];
    squares += (k - 600) * (k - 600) * large.probability[i];
  }
  CHECK(mean == Approx(600).epsilon(1e-12));
  CHECK(squares == Approx(420).epsilon(1e-10));
}

TEST_CASE("an alias table gives back the probabilities it was made from", "[analysis]") {
  const std::vector<double> probability = {0.5, 0.0, 0.2, 0.29, 0.01};
  const AliasTable table(probability);
  // Evenly spaced numbers over all 64-bit values: the shares come out within the spacing.
  constexpr int kSteps = 1 << 20;
  std::vector<int> counts(probability.size());
  for (int i = 0; i < kSteps; ++i) ++counts[table.draw(static_cast<std::uint64_t>(i) << 44U)];
  for (std::size_t i = 0; i < counts.size(); ++i)
    CHECK(counts[i] / static_cast<double>(kSteps) == Approx(probability[i]).margin(1e-5));
  CHECK(counts[1] == 0);
}

TEST_CASE("every outcome of a cell has its probability, and all together have 1", "[analysis]") {
  for (const ClassSizes sizes : {ClassSizes::random, ClassSizes::balanced}) {
    for (const Correction correction : {Correction::none, Correction::loglinear, Correction::half}) {
      for (const int trials : {1, 2, 5, 12}) {
        const CellProbabilities cell = model(trials, sizes, correction);
        const CellDistribution found = cell_distribution(cell);
        CHECK(total(found) == Approx(1).epsilon(1e-12));
        // Moments and special cases against the enumeration by yes_no().
        double missing = 0, plus = 0, minus = 0, undefined = 0, mean = 0, squares = 0, uninformative = 0;
        for_all_counts(cell, [&](const Counts& counts, double probability) {
          const YesNo rates = yes_no(counts, correction);
          if (rates.status == RateStatus::missing)
            missing += probability;
          else if (std::isnan(rates.dprime))
            undefined += probability;
          else if (std::isinf(rates.dprime))
            (rates.dprime > 0 ? plus : minus) += probability;
          else {
            mean += probability * rates.dprime;
            squares += probability * rates.dprime * rates.dprime;
            if (rates.status == RateStatus::no_information) uninformative += probability;
          }
        });
        double found_mean = 0, found_squares = 0, found_uninformative = 0;
        for (const CellState& state : found.states) {
          found_mean += state.probability * state.dprime;
          found_squares += state.probability * state.dprime * state.dprime;
          if (!state.informative) found_uninformative += state.probability;
        }
        CHECK(found.missing == Approx(missing).margin(1e-14));
        CHECK(found.plus_infinity == Approx(plus).margin(1e-14));
        CHECK(found.minus_infinity == Approx(minus).margin(1e-14));
        CHECK(found.undefined == Approx(undefined).margin(1e-14));
        CHECK(found_mean == Approx(mean).margin(1e-12));
        CHECK(found_squares == Approx(squares).margin(1e-12));
        CHECK(found_uninformative == Approx(uninformative).margin(1e-14));
      }
    }
  }
}

TEST_CASE("states are in order and each value stands once", "[analysis]") {
  CHECK(counts_of_cell(12, ClassSizes::random) == 455);
  CHECK(counts_of_cell(12, ClassSizes::balanced) == 49);
  CHECK(counts_of_cell(1, ClassSizes::balanced) == 2);
  const CellDistribution cell = cell_distribution(model(12, ClassSizes::random, Correction::loglinear));
  // Exchanging the classes leaves d' as it is: about half of the 455 counts, less 26 with an empty class, remain.
  CHECK(cell.states.size() < 230);
  for (std::size_t i = 1; i < cell.states.size(); ++i)
    CHECK(cell.states[i].dprime >= cell.states[i - 1].dprime - 1e-12);
}

TEST_CASE("risks are the sums over all counts", "[analysis]") {
  for (const ClassSizes sizes : {ClassSizes::random, ClassSizes::balanced}) {
    for (const Correction correction : {Correction::none, Correction::loglinear, Correction::half}) {
      for (const int trials : {1, 2, 6, 12}) {
        for (const double hit : {0.35, 0.8, 1.0}) {
          const CellProbabilities cell = model(trials, sizes, correction, hit, 0.3);
          double missing = 0, extreme = 0, not_positive = 0;
          for_all_counts(cell, [&](const Counts& counts, double probability) {
            const YesNo rates = yes_no(counts, correction);
            const bool empty = rates.status == RateStatus::missing;
            if (empty) missing += probability;
            if (empty || rates.raw_hit_rate == 0 || rates.raw_hit_rate == 1 || rates.raw_false_alarm_rate == 0 ||
                rates.raw_false_alarm_rate == 1)
              extreme += probability;
            if (!empty && rates.dprime < 1e-9) not_positive += probability;
          });
          const CellRisks risks = cell_risks(cell);
          CAPTURE(trials, hit, to_string(correction));
          CHECK(risks.missing == Approx(missing).margin(1e-14));
          CHECK(risks.extreme == Approx(extreme).margin(1e-12));
          CHECK(risks.not_positive == Approx(not_positive).margin(1e-12));
        }
      }
    }
  }
}

TEST_CASE("risks of the largest cells stay probabilities and fade with the trials", "[analysis]") {
  double last = 1;
  for (const int trials : {20, 100, 500, 2000}) {
    const CellRisks risks = cell_risks(model(trials, ClassSizes::random, Correction::loglinear, 0.6, 0.45));
    CHECK(risks.not_positive >= 0);
    CHECK(risks.not_positive < last);
    CHECK(risks.missing >= 0);
    last = risks.not_positive;
  }
}

TEST_CASE("the criterion stands where its rule says", "[analysis]") {
  CountsDesign design;
  design.differences = {400};
  const CellProbabilities half = cell_probabilities(design, 400, 200);
  CHECK(half.hit == Approx(0.841344746068543).epsilon(1e-12));  // Phi(1)
  CHECK(half.false_alarm == Approx(1 - half.hit).epsilon(1e-12));
  design.criterion.kind = CriterionRule::Kind::common;
  design.criterion.common = 100;
  const CellProbabilities common = cell_probabilities(design, 400, 200);
  CHECK(common.hit == Approx(0.933192798731142).epsilon(1e-12));          // Phi(1.5)
  CHECK(common.false_alarm == Approx(0.308537538725987).epsilon(1e-12));  // Phi(-0.5)
}

TEST_CASE("asymptotic variance of d' is that of the rates, infinite where a rate is certain", "[analysis]") {
  // n Var(d') -> the exact variance times n, from the distribution of a large balanced cell.
  const CellProbabilities cell = model(400, ClassSizes::balanced, Correction::loglinear, 0.7, 0.3);
  double mean = 0, squares = 0;
  for (const CellState& state : cell_distribution(cell).states) {
    mean += state.probability * state.dprime;
    squares += state.probability * state.dprime * state.dprime;
  }
  CHECK((squares - mean * mean) * 400 == Approx(asymptotic_variance(cell)).epsilon(0.01));
  CHECK(asymptotic_variance(model(12, ClassSizes::balanced, Correction::loglinear, 1, 0)) == kInf);
}

// The exact distribution of the JND against every combination of counts put through least_squares_jnd().

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
