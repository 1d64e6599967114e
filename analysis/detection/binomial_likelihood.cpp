#include "analysis/detection/binomial_likelihood.h"

#include <cmath>
#include <cstdint>

#include "analysis/numerics/normal.h"

namespace jnd {

namespace {

// count log(p), with 0 log 0 = 0. Next to p = 1 its complement q has the digits.
double times_log(double count, double p, double q) noexcept {
  if (count == 0) return 0;
  return count * (p > 0.5 ? std::log1p(-q) : std::log(p));
}

// (1 + t) log(1 + t) - t for t >= -1, by its series where the terms would cancel.
double deviance_term(double t) noexcept {
  if (t <= -1) return 1;
  if (std::abs(t) > 0.05) return (1 + t) * std::log1p(t) - t;
  double power = t * t, sum = 0;
  for (int j = 2; j < 16; ++j) {
    sum += power / (j * (j - 1));
    power *= -t;
  }
  return sum;
}

}  // namespace

double saturated_log_likelihood(int k, int n) noexcept {
  const double trials = n;
  return binomial_log_likelihood(k, n, k / trials, (n - k) / trials);
}

double binomial_log_likelihood(int k, int n, double rate, double complement) noexcept {
  return times_log(k, rate, complement) + times_log(n - k, complement, rate);
}

double saturated_log_likelihood(const Counts& counts) noexcept {
  return saturated_log_likelihood(counts.hits, counts.n_diff) +
         saturated_log_likelihood(counts.false_alarms, counts.n_same);
}

double pooled_log_likelihood(const Counts& counts) noexcept {
  const double trials = static_cast<double>(counts.n_diff) + counts.n_same;
  const double different = static_cast<double>(counts.hits) + counts.false_alarms;
  const double same = trials - different;
  return times_log(different, different / trials, same / trials) + times_log(same, same / trials, different / trials);
}

double half_deviance_of_equal_rates(const Counts& counts) noexcept {
  // observed - expected of a cell is +-excess / trials, with the integer excess = h n_same - f n_diff exact.
  const auto excess = static_cast<double>(std::int64_t{counts.hits} * counts.n_same -
                                          std::int64_t{counts.false_alarms} * counts.n_diff);
  const double trials = static_cast<double>(counts.n_diff) + counts.n_same;
  const double different = static_cast<double>(counts.hits) + counts.false_alarms;
  const double same = trials - different;
  if (different == 0 || same == 0) return 0;
  double sum = 0;
  const auto add = [&](double class_trials, double answers, double sign) {
    const double expected = class_trials * answers / trials;
    sum += expected * deviance_term(sign * excess / (class_trials * answers));
  };
  add(counts.n_diff, different, 1);
  add(counts.n_diff, same, -1);
  add(counts.n_same, different, -1);
  add(counts.n_same, same, 1);
  return sum;
}

ProbitLikelihood probit_log_likelihood(int k, int n, double x) noexcept {
  // Written in a = |x|: the counts on the side of the tail, Phi(-a), and on the other, 1 - Phi(-a).
  const double a = std::abs(x), sign = x < 0 ? -1 : 1;
  const double in_tail = x < 0 ? k : n - k, in_body = x < 0 ? n - k : k;
  double log_tail = 0, tail_hazard = 0, log_body = 0, body_hazard = 0;
  if (a < 30) {
    const double tail = normal_cdf(-a), density = normal_density(a);
    log_tail = std::log(tail);
    log_body = std::log1p(-tail);
    tail_hazard = density / tail;
    body_hazard = density / (1 - tail);
  } else {  // Phi(-a) would soon underflow: its asymptotic series, of relative error below 1e-10 / a^2
    const double r = 1 / (a * a);
    const double series = 1 - r * (1 - r * (3 - r * (15 - 105 * r)));
    log_tail = -0.5 * a * a + std::log(normal_density(0) / a * series);
    tail_hazard = a / series;
  }
  ProbitLikelihood result;
  result.value = (in_tail > 0 ? in_tail * log_tail : 0) + in_body * log_body;
  result.slope = sign * (in_body * body_hazard - in_tail * tail_hazard);
  result.curvature = -in_tail * tail_hazard * (tail_hazard - a) - in_body * body_hazard * (body_hazard + a);
  return result;
}

}  // namespace jnd
