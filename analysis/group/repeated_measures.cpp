#include "analysis/group/repeated_measures.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "analysis/numerics/moments.h"
#include "analysis/numerics/special_values.h"

namespace jnd {

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

}  // namespace jnd
