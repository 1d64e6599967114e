#include "analysis/behaviour/correctness_trend.h"

#include <algorithm>
#include <cmath>

#include <boost/math/special_functions/gamma.hpp>

#include "analysis/numerics/normal.h"
#include "analysis/numerics/special_values.h"
#include "analysis/numerics/words.h"

namespace jnd {

namespace {

double saturated(int k, int n) noexcept {
  double sum = 0;
  if (k > 0) sum += k * std::log(static_cast<double>(k) / n);
  if (k < n) sum += (n - k) * std::log(static_cast<double>(n - k) / n);
  return sum;
}

// log(1 / (1 + exp(-x))), without overflow.
double log_logistic(double x) noexcept {
  return x > 0 ? -std::log1p(std::exp(-x)) : x - std::log1p(std::exp(x));
}

// The log-likelihood at intercept a (at t = centre) and slope b, its gradient and its information matrix.
struct Likelihood {
  double value = 0, d_a = 0, d_b = 0, i_aa = 0, i_ab = 0, i_bb = 0;
  double determinant() const noexcept { return i_aa * i_bb - i_ab * i_ab; }
};
Likelihood likelihood(std::span<const JudgedTrial> trials, double centre, double a, double b) noexcept {
  Likelihood sum;
  for (const JudgedTrial& trial : trials) {
    const double t = trial.time_fraction - centre, x = a + b * t;
    const double p = 1 / (1 + std::exp(-x)), residual = (trial.correct() ? 1 : 0) - p, weight = p * (1 - p);
    sum.value += log_logistic(trial.correct() ? x : -x);
    sum.d_a += residual;
    sum.d_b += residual * t;
    sum.i_aa += weight;
    sum.i_ab += weight * t;
    sum.i_bb += weight * t * t;
  }
  return sum;
}

// What the times of correct and wrong answers are.
struct Times {
  double first_correct = kInf, last_correct = -kInf, first_wrong = kInf, last_wrong = -kInf;
  int correct = 0;
  double mean = 0;
};
Times times_of(std::span<const JudgedTrial> trials) noexcept {
  Times times;
  for (const JudgedTrial& trial : trials) {
    const double t = trial.time_fraction;
    times.mean += t / static_cast<double>(trials.size());
    double& first = trial.correct() ? times.first_correct : times.first_wrong;
    double& last = trial.correct() ? times.last_correct : times.last_wrong;
    first = std::min(first, t);
    last = std::max(last, t);
    times.correct += trial.correct() ? 1 : 0;
  }
  return times;
}

// The limit of the log-likelihood where the answers are separated at a moment: only trials of that moment are
// uncertain.
double separated_log_likelihood(std::span<const JudgedTrial> trials, double moment) noexcept {
  int correct = 0, n = 0;
  for (const JudgedTrial& trial : trials) {
    if (trial.time_fraction != moment) continue;
    ++n;
    correct += trial.correct() ? 1 : 0;
  }
  return saturated(correct, n);
}

constexpr auto kTrendStatusWords = words<TrendStatus>({{"ok", TrendStatus::ok},
                                                       {"separated", TrendStatus::separated},
                                                       {"no_variation", TrendStatus::no_variation},
                                                       {"no_times", TrendStatus::no_times}});

}  // namespace

std::string_view to_string(TrendStatus status) noexcept {
  return word_of(kTrendStatusWords, status);
}

CorrectnessTrend correctness_trend(std::span<const JudgedTrial> trials) {
  const Times times = times_of(trials);
  CorrectnessTrend trend;
  trend.n = static_cast<int>(trials.size());
  trend.correct = times.correct;
  trend.intercept = trend.slope = trend.se = trend.ci_low = trend.ci_high = trend.p = kNaN;
  if (std::min(times.first_correct, times.first_wrong) >= std::max(times.last_correct, times.last_wrong)) return trend;
  if (trend.correct == 0 || trend.correct == trend.n) {
    trend.status = TrendStatus::no_variation;
    return trend;
  }
  const double null = saturated(trend.correct, trend.n);
  const auto p_of = [null](double value) { return boost::math::gamma_q(0.5, std::fmax(0, value - null)); };

  const bool rises = times.last_wrong <= times.first_correct, falls = times.last_correct <= times.first_wrong;
  if (rises || falls) {
    trend.status = TrendStatus::separated;
    trend.slope = rises ? kInf : -kInf;
    trend.p = p_of(separated_log_likelihood(trials, rises ? times.first_correct : times.first_wrong));
    return trend;
  }

  // Newton's method on a concave function, with half steps where a whole one goes too far.
  double a = std::log(static_cast<double>(trend.correct) / (trend.n - trend.correct)), b = 0;
  Likelihood at = likelihood(trials, times.mean, a, b);
  for (int i = 0; i < 100; ++i) {
    const double step_a = (at.i_bb * at.d_a - at.i_ab * at.d_b) / at.determinant();
    const double step_b = (at.i_aa * at.d_b - at.i_ab * at.d_a) / at.determinant();
    double share = 1;
    Likelihood next = likelihood(trials, times.mean, a + step_a, b + step_b);
    // Less by no more than rounding is no step too far.
    while (!(next.value >= at.value - 1e-12 * std::abs(at.value)) && share > 1e-6) {
      share /= 2;
      next = likelihood(trials, times.mean, a + share * step_a, b + share * step_b);
    }
    a += share * step_a;
    b += share * step_b;
    at = next;
    if (std::abs(step_a) <= 1e-12 * (1 + std::abs(a)) && std::abs(step_b) <= 1e-12 * (1 + std::abs(b))) break;
  }
  trend.status = TrendStatus::ok;
  trend.slope = b;
  trend.intercept = a - b * times.mean;
  trend.se = std::sqrt(at.i_aa / at.determinant());
  trend.ci_low = b - kNormal975 * trend.se;
  trend.ci_high = b + kNormal975 * trend.se;
  trend.p = p_of(at.value);
  return trend;
}

}  // namespace jnd
