#include "protocols/extreme_rates.h"

#include <algorithm>
#include <cmath>

#include "analysis/normal.h"

namespace jnd {
namespace {

constexpr double kAssumedWeber = 0.25;

double expected_jnd(const Protocol& protocol, std::string_view condition) {
  for (const PublishedValue& value : protocol.published)
    if (value.condition == condition && value.quantity == "jnd" && value.value > 0) return value.value;
  return kAssumedWeber * protocol.stimulus.reference;
}

// The probability that n answers give a rate of neither 0 nor 1.
double inner(double rate, int n) {
  return n == 0 ? 0 : 1 - std::pow(rate, n) - std::pow(1 - rate, n);
}

double inner_of_series(double hit, double false_alarm, int trials, Sampling sampling) {
  if (sampling == Sampling::balanced) return inner(hit, trials / 2) * inner(false_alarm, trials - trials / 2);
  double sum = 0;
  double log_binomial = -trials * std::log(2.0);  // of n_diff = 0
  for (int n_diff = 0; n_diff <= trials; ++n_diff) {
    sum += std::exp(log_binomial) * inner(hit, n_diff) * inner(false_alarm, trials - n_diff);
    log_binomial += std::log(static_cast<double>(trials - n_diff)) - std::log(n_diff + 1.0);
  }
  return sum;
}

}  // namespace

double extreme_rate_probability(const Protocol& protocol, std::string_view condition) {
  const double jnd = expected_jnd(protocol, condition);
  double none = 1;
  for (const Series& series : protocol.series) {
    const double dprime = std::abs(series.pair[0] - series.pair[1]) / jnd;
    none *= inner_of_series(normal_cdf(dprime / 2), normal_cdf(-dprime / 2), protocol.design.trials_per_cell,
                            protocol.design.sampling);
  }
  return std::clamp(1 - none, 0.0, 1.0);
}

}  // namespace jnd
