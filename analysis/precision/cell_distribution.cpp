#include "analysis/precision/cell_distribution.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "analysis/numerics/binomial.h"
#include "analysis/numerics/normal.h"
#include "analysis/numerics/special_values.h"

namespace jnd {

namespace {

constexpr double kSameRate = 1e-12;  // values this close differ by rounding only

// Calls with n_diff, n_same and the probability of these class sizes.
void for_class_sizes(const CellProbabilities& cell, const std::function<void(int, int, double)>& call) {
  if (cell.class_sizes == ClassSizes::balanced) {
    call(cell.trials - cell.trials / 2, cell.trials / 2, 1);
    return;
  }
  const BinomialTable same = binomial_table(cell.trials, 0.5);
  for (std::size_t i = 0; i < same.probability.size(); ++i) {
    const int n_same = same.first + static_cast<int>(i);
    call(cell.trials - n_same, n_same, same.probability[i]);
  }
}

// What a class of n trials can give: a row for each number of answers "different" with a probability worth the name.
struct ClassOutcome {
  int answers = 0;  // hits or false alarms
  double probability = 0;
  double rate = 0;  // corrected
  double z = 0;
  double variance = 0;  // of z
};

std::vector<ClassOutcome> class_outcomes(int n, double p, Correction correction) {
  const BinomialTable table = binomial_table(n, p);
  std::vector<ClassOutcome> outcomes;
  for (std::size_t i = 0; i < table.probability.size(); ++i) {
    ClassOutcome outcome;
    outcome.answers = table.first + static_cast<int>(i);
    outcome.probability = table.probability[i];
    outcome.rate = corrected_rate(outcome.answers, n, correction);
    outcome.z = normal_quantile(outcome.rate);
    const double density = normal_density(outcome.z);
    outcome.variance = outcome.rate * (1 - outcome.rate) / (n * density * density);
    outcomes.push_back(outcome);
  }
  return outcomes;
}

double extreme_share(int n, double p) {
  return std::pow(p, n) + std::pow(1 - p, n);
}

// P(corrected H <= corrected F), both given by their numbers of answers. Without correction, equal rates of 0 or of 1
// have no d'.
double not_positive_share(int n_diff, int n_same, const CellProbabilities& cell) {
  const BinomialTable hits = binomial_table(n_diff, cell.hit);
  const BinomialTable false_alarms = binomial_table(n_same, cell.false_alarm);
  // Both rates grow with the number of answers: the first false alarm that reaches H moves upwards with H.
  std::size_t at = 0;
  double above = 1, sum = 0;
  for (std::size_t i = 0; i < hits.probability.size(); ++i) {
    const double hit = corrected_rate(hits.first + static_cast<int>(i), n_diff, cell.correction);
    while (at < false_alarms.probability.size() &&
           corrected_rate(false_alarms.first + static_cast<int>(at), n_same, cell.correction) < hit - kSameRate)
      above -= false_alarms.probability[at++];
    if (at == false_alarms.probability.size()) break;
    sum += hits.probability[i] * above;
    if (hit == 0 && false_alarms.first == 0) sum -= hits.probability[i] * false_alarms.probability[0];
    if (hit == 1 && at + 1 == false_alarms.probability.size()) sum -= hits.probability[i] * above;
  }
  return std::max(sum, 0.0);
}

bool equal_but_for_rounding(const CellState& a, const CellState& b) {
  return a.informative == b.informative && std::abs(a.dprime - b.dprime) < kSameRate &&
         std::abs(a.variance - b.variance) <= 1e-9 * b.variance;
}

// Exchanging the two classes and their answers gives the same d': half of all counts are such copies.
std::vector<CellState> merged(std::vector<CellState> states) {
  std::sort(states.begin(), states.end(), [](const CellState& a, const CellState& b) { return a.dprime < b.dprime; });
  std::vector<CellState> result;
  std::size_t group = 0;  // where the states of about this d' begin
  for (const CellState& state : states) {
    while (group < result.size() && result[group].dprime < state.dprime - kSameRate) ++group;
    const auto same = std::find_if(result.begin() + static_cast<std::ptrdiff_t>(group), result.end(),
                                   [&](const CellState& other) { return equal_but_for_rounding(state, other); });
    if (same == result.end())
      result.push_back(state);
    else
      same->probability += state.probability;
  }
  return result;
}

}  // namespace

CellProbabilities cell_probabilities(const CountsDesign& design, double difference, double jnd) {
  const double criterion =
      design.criterion.kind == CriterionRule::Kind::common ? design.criterion.common : difference / 2;
  CellProbabilities cell;
  cell.hit = normal_cdf((difference - criterion) / jnd);
  cell.false_alarm = normal_cdf(-criterion / jnd);
  cell.trials = design.trials;
  cell.class_sizes = design.class_sizes;
  cell.correction = design.correction;
  return cell;
}

CellRisks cell_risks(const CellProbabilities& cell) {
  CellRisks risks;
  for_class_sizes(cell, [&](int n_diff, int n_same, double probability) {
    if (n_diff == 0 || n_same == 0) {
      risks.missing += probability;
      risks.extreme += probability;
      return;
    }
    const double inner = (1 - extreme_share(n_diff, cell.hit)) * (1 - extreme_share(n_same, cell.false_alarm));
    risks.extreme += probability * (1 - std::max(inner, 0.0));
    risks.not_positive += probability * not_positive_share(n_diff, n_same, cell);
  });
  return risks;
}

CellDistribution cell_distribution(const CellProbabilities& cell) {
  CellDistribution result;
  std::vector<CellState> states;
  for_class_sizes(cell, [&](int n_diff, int n_same, double probability) {
    if (n_diff == 0 || n_same == 0) {
      result.missing += probability;
      return;
    }
    const std::vector<ClassOutcome> hits = class_outcomes(n_diff, cell.hit, cell.correction);
    const std::vector<ClassOutcome> false_alarms = class_outcomes(n_same, cell.false_alarm, cell.correction);
    for (const ClassOutcome& hit : hits) {
      for (const ClassOutcome& false_alarm : false_alarms) {
        CellState state;
        state.dprime = hit.z - false_alarm.z;
        state.variance = hit.variance + false_alarm.variance;
        state.probability = probability * hit.probability * false_alarm.probability;
        state.informative = !(hit.answers == 0 && false_alarm.answers == 0) &&
                            !(hit.answers == n_diff && false_alarm.answers == n_same);
        if (std::isnan(state.dprime))
          result.undefined += state.probability;
        else if (std::isinf(state.dprime))
          (state.dprime > 0 ? result.plus_infinity : result.minus_infinity) += state.probability;
        else
          states.push_back(state);
      }
    }
  });
  result.states = merged(std::move(states));
  return result;
}

std::int64_t counts_of_cell(int trials, ClassSizes class_sizes) noexcept {
  const std::int64_t n = trials;
  if (class_sizes == ClassSizes::balanced) return (n / 2 + 1) * (n - n / 2 + 1);
  return (n + 1) * (n + 2) * (n + 3) / 6;
}

double asymptotic_variance(const CellProbabilities& cell) noexcept {
  double sum = 0;
  for (const double rate : {cell.hit, cell.false_alarm}) {
    const double density = normal_density(normal_quantile(rate));
    if (!(density * density > 0)) return kInf;
    sum += 2 * rate * (1 - rate) / (density * density);
  }
  return sum;
}

}  // namespace jnd
