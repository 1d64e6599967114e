#include "analysis/group/within_effect.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/numerics/moments.h"
#include "analysis/numerics/special_values.h"
#include "analysis/numerics/tail_probabilities.h"

namespace jnd {

namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

// The symmetric matrix A = L D L', with unit lower L in place of the lower triangle and D on the diagonal.
struct Factors {
  std::vector<double> a;  // p x p, row-major
  std::size_t p;
  bool singular = false;

  // least: a pivot (a sum of squares) that rounding of the data alone would leave.
  Factors(std::vector<double> matrix, std::size_t size, double least) : a(std::move(matrix)), p(size) {
    for (std::size_t j = 0; j < p; ++j) {
      const double before = a[j * p + j];
      for (std::size_t m = 0; m < j; ++m) a[j * p + j] -= a[j * p + m] * a[j * p + m] * a[m * p + m];
      const double pivot = a[j * p + j];
      if (!(pivot > 64 * static_cast<double>(p) * kEpsilon * before && pivot > least)) {
        singular = true;
        return;
      }
      for (std::size_t i = j + 1; i < p; ++i) {
        for (std::size_t m = 0; m < j; ++m) a[i * p + j] -= a[i * p + m] * a[j * p + m] * a[m * p + m];
        a[i * p + j] /= pivot;
      }
    }
  }
  // v' A^-1 v
  double inverse_form(std::vector<double> v) const {
    double sum = 0;
    for (std::size_t j = 0; j < p; ++j) {
      for (std::size_t m = 0; m < j; ++m) v[j] -= a[j * p + m] * v[m];
      sum += v[j] * v[j] / a[j * p + j];
    }
    return sum;
  }
};

// W = det(A) / (trace(A)/p)^p, and its p with n - 1 degrees of freedom.
Mauchly mauchly(const Factors& factors, double trace, double n) {
  Mauchly result;
  const auto p = static_cast<double>(factors.p);
  double log_w = 0;
  for (std::size_t j = 0; j < factors.p; ++j) log_w += std::log(factors.a[j * factors.p + j] / (trace / p));
  log_w = std::min(0.0, log_w);
  result.w = std::exp(log_w);
  if (factors.p == 2) {
    result.p = std::exp(0.5 * (n - 2) * log_w);
    return result;
  }
  const double df = n - 1, k = p + 1;
  const double rho = 1 - (2 * p * p + p + 2) / (6 * p * df);
  // R's mauchly.test has 3 k where Anderson has 3 p; kept, for the same digits as R.
  const double w2 =
      (p + 2) * (p - 1) * (p - 2) * (2 * p * p * p + 6 * p * p + 3 * k + 2) / (288 * (df * p * rho) * (df * p * rho));
  const double chi2 = -df * rho * log_w, f = p * (p + 1) / 2 - 1;
  const double first = chi2_upper(chi2, f), second = chi2_upper(chi2, f + 4);
  result.p = std::clamp(first + w2 * (second - first), 0.0, 1.0);
  return result;
}

WithinEffect undefined(std::size_t contrasts, StatisticStatus status) {
  WithinEffect effect;
  effect.status = effect.hotelling_status = effect.mauchly.status = status;
  effect.ss = effect.ss_error = effect.f = effect.df2 = effect.p = kNaN;
  effect.epsilon_gg = effect.epsilon_hf = effect.p_gg = effect.p_hf = effect.p_lower_bound = kNaN;
  effect.eta2_partial = effect.mauchly.w = effect.mauchly.p = kNaN;
  effect.hotelling_t2 = effect.hotelling_f = effect.hotelling_df1 = effect.hotelling_df2 = effect.hotelling_p = kNaN;
  effect.df1 = static_cast<double>(contrasts);
  return effect;
}

// Greenhouse-Geisser from the covariance alone; Huynh-Feldt, uncapped, from that.
void set_epsilons(WithinEffect& effect, std::span<const double> cross, double trace, double n, double p) {
  double squares = 0;
  for (const double value : cross) squares += (value / trace) * (value / trace);
  effect.epsilon_gg = std::clamp(1 / (p * squares), 1 / p, 1.0);
  const double above = n * p * effect.epsilon_gg - 2, below = p * (n - 1 - p * effect.epsilon_gg);
  if (p == 1)
    effect.epsilon_hf = 1;
  else if (n <= 2)
    effect.epsilon_hf = kNaN;
  else
    effect.epsilon_hf = below > 8 * kEpsilon * p * n ? above / below : kInf;
}

}  // namespace

WithinEffect within_effect(std::span<const double> scores, std::size_t n, std::size_t contrasts, double scale) {
  if (n < 2 || contrasts < 1) return undefined(contrasts, StatisticStatus::too_few);
  const std::size_t p = contrasts;
  const auto rows = static_cast<double>(n), columns = static_cast<double>(p);
  // A power of two near 1/scale, so that no square overflows or vanishes and nothing is rounded.
  const double largest = largest_magnitude(scores);
  const double unit = largest > 0 ? std::ldexp(1.0, -std::clamp(std::ilogb(largest), -1000, 1000)) : 1.0;

  std::vector<double> means(p, 0.0), cross(p * p, 0.0), centred(p);
  for (std::size_t j = 0; j < p; ++j) {
    for (std::size_t i = 0; i < n; ++i) means[j] += (scores[i * p + j] - scores[j]) * unit;
    means[j] = scores[j] * unit + means[j] / rows;
  }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < p; ++j) centred[j] = scores[i * p + j] * unit - means[j];
    for (std::size_t j = 0; j < p; ++j)
      for (std::size_t m = 0; m <= j; ++m) cross[j * p + m] += centred[j] * centred[m];
  }
  double trace = 0, ss = 0;
  for (std::size_t j = 0; j < p; ++j) {
    for (std::size_t m = 0; m < j; ++m) cross[m * p + j] = cross[j * p + m];
    trace += cross[j * p + j];
    ss += rows * means[j] * means[j];
  }

  WithinEffect effect = undefined(p, StatisticStatus::no_variance);
  effect.df2 = columns * (rows - 1);
  effect.ss = ss / unit / unit;
  effect.ss_error = trace / unit / unit;
  if (ss + trace > 0) effect.eta2_partial = ss / (ss + trace);
  if (only_rounding(std::sqrt(trace / effect.df2), scale * unit)) return effect;

  effect.status = StatisticStatus::ok;
  effect.f = (ss / columns) / (trace / effect.df2);
  effect.p = f_upper(effect.f, effect.df1, effect.df2);
  set_epsilons(effect, cross, trace, rows, columns);
  const auto corrected = [&](double epsilon) {
    return std::isnan(epsilon) ? kNaN : f_upper(effect.f, epsilon * effect.df1, epsilon * effect.df2);
  };
  effect.p_gg = corrected(effect.epsilon_gg);
  effect.p_hf = corrected(std::isnan(effect.epsilon_hf) ? kNaN : std::min(1.0, effect.epsilon_hf));
  effect.p_lower_bound = corrected(1 / columns);

  const double rounding = 10 * kEpsilon * scale * unit;
  const Factors factors(cross, p, rounding * rounding * rows);
  effect.hotelling_status = n <= p             ? StatisticStatus::too_few
                            : factors.singular ? StatisticStatus::singular
                                               : StatisticStatus::ok;
  if (effect.hotelling_status == StatisticStatus::ok) {
    effect.hotelling_t2 = rows * (rows - 1) * factors.inverse_form(means);
    effect.hotelling_df1 = columns;
    effect.hotelling_df2 = rows - columns;
    effect.hotelling_f = effect.hotelling_t2 * (rows - columns) / ((rows - 1) * columns);
    effect.hotelling_p = f_upper(effect.hotelling_f, columns, rows - columns);
  }
  effect.mauchly.status = p == 1             ? StatisticStatus::not_applicable
                          : n <= p           ? StatisticStatus::too_few
                          : factors.singular ? StatisticStatus::singular
                                             : StatisticStatus::ok;
  if (effect.mauchly.status == StatisticStatus::ok) effect.mauchly = mauchly(factors, trace, rows);
  return effect;
}

std::vector<double> helmert_contrasts(std::size_t k) {
  std::vector<double> contrasts;
  for (std::size_t row = 1; row < k; ++row) {
    const auto before = static_cast<double>(row);
    const double unit = 1 / std::sqrt(before * (before + 1));
    for (std::size_t j = 0; j < k; ++j) contrasts.push_back(j < row ? unit : j == row ? -before * unit : 0.0);
  }
  return contrasts;
}

}  // namespace jnd
