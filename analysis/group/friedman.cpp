#include "analysis/group/friedman.h"

#include <cmath>
#include <cstddef>
#include <vector>

#include "analysis/numerics/ranks.h"
#include "analysis/numerics/special_values.h"
#include "analysis/numerics/tail_probabilities.h"

namespace jnd {

Friedman friedman(const WithinTable& table) {
  Friedman result;
  result.n = static_cast<int>(table.n);
  result.chi2 = result.p = result.kendall_w = result.f_iman_davenport = result.p_iman_davenport = kNaN;
  if (table.n < 2 || table.k < 2) {
    result.status = StatisticStatus::too_few;
    return result;
  }
  const auto n = static_cast<double>(table.n), k = static_cast<double>(table.k);
  result.df = static_cast<int>(table.k) - 1;
  std::vector<double> rank_sums(table.k, 0.0);
  double ties = 0;
  for (std::size_t i = 0; i < table.n; ++i) {
    const Ranks ranks = midranks(table.row(i));
    for (std::size_t j = 0; j < table.k; ++j) rank_sums[j] += ranks.ranks[j];
    ties += ranks.tie_sum;
  }
  double squares = 0;
  for (const double sum : rank_sums) squares += (sum - n * (k + 1) / 2) * (sum - n * (k + 1) / 2);
  // Whole and half numbers throughout: exact, and 0 exactly where every participant ties all conditions.
  const double spread = (n * k * (k + 1) * (k - 1) - ties) / (k - 1);
  if (!(spread > 0)) {
    result.status = StatisticStatus::no_variance;
    return result;
  }
  result.chi2 = 12 * squares / spread;
  result.p = chi2_upper(result.chi2, k - 1);
  result.kendall_w = result.chi2 / (n * (k - 1));
  const double rest = n * (k - 1) - result.chi2;
  // All rank alike: nothing is left but rounding.
  result.f_iman_davenport = rest > 1e-12 * n * k ? (n - 1) * result.chi2 / rest : kInf;
  result.p_iman_davenport = f_upper(result.f_iman_davenport, k - 1, (k - 1) * (n - 1));
  return result;
}

}  // namespace jnd
