// The joint likelihoods written down plainly, with nested golden sections instead of derivatives: slow, and independent
// of the product's own likelihoods, starts and stops.
#pragma once

#include <cmath>
#include <functional>
#include <span>

#include "analysis/numerics/normal.h"
#include "analysis/thresholds/jnd.h"

namespace jnd::oracle {

inline bool is_differencing(JndMethod method) {
  return method == JndMethod::ml_differencing_common || method == JndMethod::ml_differencing_series;
}

// Logarithm of a probability that may underflow; z: what its tail falls with, so that searches see a slope there.
inline double log_of(double probability, double z) {
  return probability > 0 ? std::log(probability) : -0.5 * z * z - 10;
}

struct Answer {
  double different, same;  // logarithms of the probabilities
};
inline Answer answer(JndMethod method, double criterion, double d) {
  if (!is_differencing(method)) {
    const double z = criterion + d;
    return {log_of(normal_cdf(z), z), log_of(normal_cdf(-z), z)};
  }
  const double a = (criterion - d) / std::sqrt(2.0), b = (-criterion - d) / std::sqrt(2.0);
  const double same = a > 0 ? 1 - normal_cdf(-a) - normal_cdf(b) : normal_cdf(a) - normal_cdf(b);
  return {log_of(normal_cdf(-a) + normal_cdf(b), a), log_of(same, a)};
}

inline double log_likelihood(double k, double n, const Answer& answer) {
  return (k > 0 ? k * answer.different : 0) + (k < n ? (n - k) * answer.same : 0);
}

// Where a function with one maximum in a..b has it.
inline double golden(const std::function<double(double)>& function, double a, double b) {
  const double ratio = 0.6180339887498949;
  double c = b - ratio * (b - a), d = a + ratio * (b - a);
  double at_c = function(c), at_d = function(d);
  while (b - a > 1e-9 * (std::abs(a) + std::abs(b)) + 1e-12) {
    if (at_c > at_d) {
      b = d;
      d = c;
      at_d = at_c;
      c = b - ratio * (b - a);
      at_c = function(c);
    } else {
      a = c;
      c = d;
      at_c = at_d;
      d = a + ratio * (b - a);
      at_d = function(d);
    }
  }
  return 0.5 * (a + b);
}

inline double probability(JndMethod method, double criterion, double d) {
  return std::exp(answer(method, criterion, d).different);
}

// The likelihood at slope m with the best criteria.
inline double profile(std::span<const SeriesCounts> series, JndMethod method, double m) {
  const bool common = method == JndMethod::ml_yes_no_common || method == JndMethod::ml_differencing_common;
  const auto of = [&](const SeriesCounts& one, double criterion) {
    return log_likelihood(one.counts.hits, one.counts.n_diff, answer(method, criterion, m * one.difference)) +
           log_likelihood(one.counts.false_alarms, one.counts.n_same, answer(method, criterion, 0));
  };
  const double low = is_differencing(method) ? 0 : -45, high = is_differencing(method) ? 60 : 45;
  double sum = 0;
  if (common) {
    const auto all = [&](double criterion) {
      double together = 0;
      for (const SeriesCounts& one : series) together += of(one, criterion);
      return together;
    };
    return all(golden(all, low, high));
  }
  for (const SeriesCounts& one : series) {
    const auto alone = [&](double criterion) { return of(one, criterion); };
    sum += alone(golden(alone, low, high));
  }
  return sum;
}

// The highest likelihood over m in low..high, by a grid and golden sections around its best point.
inline double best_slope(std::span<const SeriesCounts> series, JndMethod method, double low, double high) {
  constexpr int kGrid = 120;
  const double step = (high - low) / kGrid;
  double best = low, best_value = -HUGE_VAL;
  for (int i = 0; i <= kGrid; ++i) {
    const double value = profile(series, method, low + i * step);
    if (value > best_value) {
      best_value = value;
      best = low + i * step;
    }
  }
  return golden([&](double m) { return profile(series, method, m); }, std::fmax(low, best - step),
                std::fmin(high, best + step));
}

}  // namespace jnd::oracle
