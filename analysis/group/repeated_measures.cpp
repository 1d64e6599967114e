#include "analysis/group/repeated_measures.h"

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

// Every product of a row of a (rows_a x la) with a row of b (rows_b x lb): contrasts over the la * lb cells.
std::vector<double> products(const std::vector<double>& a, std::size_t la, const std::vector<double>& b,
                             std::size_t lb) {
  std::vector<double> result;
  for (std::size_t i = 0; i < a.size(); i += la)
    for (std::size_t j = 0; j < b.size(); j += lb)
      for (std::size_t s = 0; s < la; ++s)
        for (std::size_t t = 0; t < lb; ++t) result.push_back(a[i + s] * b[j + t]);
  return result;
}

std::vector<double> scores_on(const std::vector<double>& contrasts, const std::vector<double>& x, std::size_t n) {
  const std::size_t cells = x.size() / n;
  std::vector<double> scores;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t c = 0; c < contrasts.size(); c += cells) {
      double sum = 0;
      for (std::size_t cell = 0; cell < cells; ++cell) sum += contrasts[c + cell] * x[i * cells + cell];
      scores.push_back(sum);
    }
  }
  return scores;
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

RepeatedMeasures repeated_measures(const WithinTable& table) {
  RepeatedMeasures result;
  result.ss_subjects = result.eta2_generalised = result.omega2_partial = result.cohen_f = kNaN;
  if (table.n < 2 || table.k < 2) {
    result.effect = within_effect({}, 0, table.k < 2 ? 0 : table.k - 1, 0);
    result.status = StatisticStatus::too_few;
    return result;
  }
  const std::size_t n = table.n, k = table.k;
  const auto rows = static_cast<double>(n), columns = static_cast<double>(k);
  // From a common origin: what all values share would only cost digits.
  const double origin = table.values.front();
  std::vector<double> x(table.values);
  for (double& value : x) value -= origin;

  const std::vector<double> contrasts = helmert_contrasts(k);
  std::vector<double> scores(n * (k - 1), 0.0), row_means(n, 0.0), column_means(k, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t c = 0; c + 1 < k; ++c)
      for (std::size_t j = 0; j < k; ++j) scores[i * (k - 1) + c] += contrasts[c * k + j] * x[i * k + j];
    for (std::size_t j = 0; j < k; ++j) {
      row_means[i] += x[i * k + j] / columns;
      column_means[j] += x[i * k + j] / rows;
    }
  }
  result.effect = within_effect(scores, n, k - 1, largest_magnitude(table.values));
  result.status = result.effect.status;

  const Moments of_rows = moments(row_means);
  result.ss_subjects = columns * (rows - 1) * of_rows.sd * of_rows.sd;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < k; ++j)
      result.residuals.push_back((x[i * k + j] - row_means[i]) - (column_means[j] - of_rows.mean));

  const WithinEffect& effect = result.effect;
  const double total = effect.ss + effect.ss_error + result.ss_subjects;
  if (total > 0) result.eta2_generalised = effect.ss / total;
  if (result.status == StatisticStatus::ok) {
    const double above = effect.df1 * (effect.f - 1);
    result.omega2_partial = above / (above + rows * columns);
    result.cohen_f = std::sqrt(effect.ss / effect.ss_error);
  }
  return result;
}

TwoWayWithin two_way_within(const TwoWayTable& table) {
  TwoWayWithin result;
  result.ss_subjects = kNaN;
  result.a.eta2_generalised = result.b.eta2_generalised = result.ab.eta2_generalised = kNaN;
  const std::size_t a = table.a, b = table.b, n = table.n;
  if (n < 2 || a < 2 || b < 2) {
    result.status = StatisticStatus::too_few;
    result.a.effect = within_effect({}, 0, a < 2 ? 0 : a - 1, 0);
    result.b.effect = within_effect({}, 0, b < 2 ? 0 : b - 1, 0);
    result.ab.effect = within_effect({}, 0, a < 2 || b < 2 ? 0 : (a - 1) * (b - 1), 0);
    return result;
  }
  const double scale = largest_magnitude(table.values);
  std::vector<double> x(table.values);
  for (double& value : x) value -= table.values.front();

  const std::vector<double> of_a = helmert_contrasts(a), of_b = helmert_contrasts(b);
  const std::vector<double> mean_a(a, 1 / std::sqrt(static_cast<double>(a)));
  const std::vector<double> mean_b(b, 1 / std::sqrt(static_cast<double>(b)));
  result.a.effect = within_effect(scores_on(products(of_a, a, mean_b, b), x, n), n, a - 1, scale);
  result.b.effect = within_effect(scores_on(products(mean_a, a, of_b, b), x, n), n, b - 1, scale);
  result.ab.effect = within_effect(scores_on(products(of_a, a, of_b, b), x, n), n, (a - 1) * (b - 1), scale);

  const Moments subjects = moments(scores_on(products(mean_a, a, mean_b, b), x, n));
  result.ss_subjects = (static_cast<double>(n) - 1) * subjects.sd * subjects.sd;
  const double errors =
      result.ss_subjects + result.a.effect.ss_error + result.b.effect.ss_error + result.ab.effect.ss_error;
  for (TwoWayEffect* one : {&result.a, &result.b, &result.ab})
    if (one->effect.ss + errors > 0) one->eta2_generalised = one->effect.ss / (one->effect.ss + errors);
  return result;
}

}  // namespace jnd
