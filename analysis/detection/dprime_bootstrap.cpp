#include "analysis/detection/dprime_bootstrap.h"

#include <cmath>
#include <vector>

#include "analysis/numerics/binomial.h"
#include "analysis/numerics/normal.h"
#include "analysis/numerics/special_values.h"

namespace jnd {

namespace {

constexpr double kTie = 1e-11;  // equal d' of different counts differ by rounding, of the order 1e-15

// The z score of the log-linear rate of one class, over all its outcomes: ascending.
struct ScoreDistribution {
  std::vector<double> z, probability, at_least;  // at_least[i] = P(z >= z[i]), with a 0 at the end
  double mean = 0, variance = 0;
};

ScoreDistribution scores(int n, int k) {
  const BinomialTable table = binomial_table(n, corrected_rate(k, n, Correction::loglinear));
  ScoreDistribution result;
  result.probability = table.probability;
  const std::size_t size = table.probability.size();
  for (std::size_t i = 0; i < size; ++i) {
    const int outcome = table.first + static_cast<int>(i);
    // From the rarer side, so that the distribution of the complement is the mirror image to the last bit.
    result.z.push_back(2.0 * outcome > n ? -normal_quantile(corrected_rate(n - outcome, n, Correction::loglinear))
                                         : normal_quantile(corrected_rate(outcome, n, Correction::loglinear)));
    result.mean += table.probability[i] * result.z[i];
  }
  result.at_least.assign(size + 1, 0);
  for (std::size_t i = size; i-- > 0;) {
    result.variance += table.probability[i] * (result.z[i] - result.mean) * (result.z[i] - result.mean);
    result.at_least[i] = result.at_least[i + 1] + table.probability[i];
  }
  return result;
}

// P(z_hit - z_alarm <= limit): both lists ascend, so one walk through each is enough.
double probability_up_to(double limit, const ScoreDistribution& hit, const ScoreDistribution& alarm) {
  double sum = 0;
  std::size_t j = 0;
  for (std::size_t i = 0; i < hit.z.size(); ++i) {
    while (j < alarm.z.size() && hit.z[i] - alarm.z[j] > limit) ++j;
    sum += hit.probability[i] * alarm.at_least[j];
  }
  return sum;
}

// The smallest difference above the limit.
double next_above(double limit, const ScoreDistribution& hit, const ScoreDistribution& alarm) {
  double best = kInf;
  std::size_t j = 0;
  for (const double z : hit.z) {
    while (j < alarm.z.size() && z - alarm.z[j] > limit) ++j;
    if (j > 0) best = std::fmin(best, z - alarm.z[j - 1]);
  }
  return best;
}

struct Quantile {
  double value, probability;
};

Quantile quantile(double p, const ScoreDistribution& hit, const ScoreDistribution& alarm) {
  double low = hit.z.front() - alarm.z.back() - 1, high = hit.z.back() - alarm.z.front();
  while (high - low > 0.25 * kTie) {
    const double middle = 0.5 * (low + high);
    (probability_up_to(middle, hit, alarm) < p ? low : high) = middle;
  }
  // Everything up to low is too little; what follows reaches p.
  const double value = next_above(low, hit, alarm);
  return {value, probability_up_to(value + kTie, hit, alarm)};
}

}  // namespace

DprimeBootstrap dprime_bootstrap(const Counts& counts) {
  if (counts.n_diff <= 0 || counts.n_same <= 0) {
    return {kNaN, kNaN, kNaN, kNaN, kNaN, kNaN};
  }
  const ScoreDistribution hit = scores(counts.n_diff, counts.hits);
  const ScoreDistribution alarm = scores(counts.n_same, counts.false_alarms);
  const Quantile lower = quantile(0.025, hit, alarm), upper = quantile(0.975, hit, alarm);
  return {hit.mean - alarm.mean, std::sqrt(hit.variance + alarm.variance), lower.value, upper.value, lower.probability,
          upper.probability};
}

}  // namespace jnd
