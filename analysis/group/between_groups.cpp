#include "analysis/group/between_groups.h"

#include <algorithm>
#include <cmath>

#include "analysis/group/p_adjust.h"
#include "analysis/numerics/moments.h"
#include "analysis/numerics/normal.h"
#include "analysis/numerics/ranks.h"
#include "analysis/numerics/special_values.h"
#include "analysis/numerics/tail_probabilities.h"

namespace jnd {

namespace {

// How many ways there are to choose `size` of the ranks 1..n with each sum above the smallest: the null distribution
// of W, as counts. Index: W = 0..size (n - size).
std::vector<double> rank_sum_counts(int n, int size) {
  const int most = size * (n - size);
  // ways[j][w]: j of the ranks so far, whose sum is w above 1 + ... + j.
  std::vector<std::vector<double>> ways(static_cast<std::size_t>(size) + 1,
                                        std::vector<double>(static_cast<std::size_t>(most) + 1, 0.0));
  ways[0][0] = 1;
  for (int rank = 1; rank <= n; ++rank)
    for (int j = std::min(rank, size); j >= 1; --j)  // the rank as the j-th: rank - j above the smallest
      for (int w = most; w >= rank - j; --w)
        ways[static_cast<std::size_t>(j)][static_cast<std::size_t>(w)] +=
            ways[static_cast<std::size_t>(j) - 1][static_cast<std::size_t>(w - (rank - j))];
  return ways.back();
}

double exact_rank_sum_p(double w, int n_x, int n_y) {
  const std::vector<double> counts = rank_sum_counts(n_x + n_y, n_x);
  const double middle = n_x * static_cast<double>(n_y) / 2;
  double tail = 0, total = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const auto at = static_cast<double>(i);
    total += counts[i];
    if (w > middle ? at >= w : at <= w) tail += counts[i];
  }
  return std::min(1.0, 2 * tail / total);
}

void correct_pairs(std::vector<GroupPair>& pairs) {
  std::vector<double> welch, ranks;
  for (const GroupPair& pair : pairs) {
    welch.push_back(pair.welch.p);
    ranks.push_back(pair.ranks.p);
  }
  welch = holm(welch);
  ranks = holm(ranks);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    pairs[i].welch_p_holm = welch[i];
    pairs[i].ranks_p_holm = ranks[i];
  }
}

}  // namespace

WelchT welch_t(std::span<const double> x, std::span<const double> y) {
  WelchT result;
  const Moments of_x = moments(x), of_y = moments(y);
  result.n_x = of_x.n;
  result.n_y = of_y.n;
  result.mean_difference = of_x.mean - of_y.mean;
  result.t = result.df = result.p = result.ci_low = result.ci_high = result.d = kNaN;
  if (of_x.n < 2 || of_y.n < 2) {
    result.status = StatisticStatus::too_few;
    return result;
  }
  const double n_x = of_x.n, n_y = of_y.n;
  const double se_x = of_x.sd / std::sqrt(n_x), se_y = of_y.sd / std::sqrt(n_y);
  const double se = std::hypot(se_x, se_y);
  if (only_rounding(se, std::max(std::abs(of_x.mean), std::abs(of_y.mean)))) {
    result.status = StatisticStatus::no_variance;
    return result;
  }
  // Of shares of the variance, so that no fourth power leaves the range of double.
  const double share_x = (se_x / se) * (se_x / se), share_y = (se_y / se) * (se_y / se);
  result.t = result.mean_difference / se;
  result.df = 1 / (share_x * share_x / (n_x - 1) + share_y * share_y / (n_y - 1));
  result.p = student_t_two_sided(result.t, result.df);
  const double half_width = student_t_quantile_two_sided(0.05, result.df) * se;
  result.ci_low = result.mean_difference - half_width;
  result.ci_high = result.mean_difference + half_width;
  const double pooled =
      std::hypot(of_x.sd * std::sqrt(n_x - 1), of_y.sd * std::sqrt(n_y - 1)) / std::sqrt(n_x + n_y - 2);
  result.d = result.mean_difference / pooled;
  return result;
}

MannWhitney mann_whitney(std::span<const double> x, std::span<const double> y) {
  MannWhitney result;
  if (x.empty() || y.empty()) {
    result.w = result.p = result.p_normal = result.rank_biserial = kNaN;
    result.status = StatisticStatus::too_few;
    return result;
  }
  std::vector<double> all(x.begin(), x.end());
  all.insert(all.end(), y.begin(), y.end());
  const Ranks ranks = midranks(all);
  const auto n_x = static_cast<double>(x.size()), n_y = static_cast<double>(y.size()), n = n_x + n_y;
  for (std::size_t i = 0; i < x.size(); ++i) result.w += ranks.ranks[i];
  result.w -= n_x * (n_x + 1) / 2;
  result.ties = ranks.tie_sum > 0;
  result.rank_biserial = 2 * result.w / (n_x * n_y) - 1;
  const double variance = n_x * n_y / 12 * (n + 1 - ranks.tie_sum / (n * (n - 1)));
  if (!(ranks.tie_sum < n * n * n - n)) {  // one group of ties
    result.p = result.p_normal = kNaN;
    result.status = StatisticStatus::no_variance;
    return result;
  }
  const double off = std::abs(result.w - n_x * n_y / 2);
  result.p_normal = std::min(1.0, 2 * normal_cdf(-std::max(0.0, off - 0.5) / std::sqrt(variance)));
  result.exact = !result.ties && x.size() < kLeastNormalMannWhitney && y.size() < kLeastNormalMannWhitney;
  result.p = result.exact ? exact_rank_sum_p(result.w, static_cast<int>(x.size()), static_cast<int>(y.size()))
                          : result.p_normal;
  return result;
}

GroupComparison compare_groups(const GroupedTable& table) {
  GroupComparison found;
  found.anova = mixed_anova(table);
  for (std::size_t j = 0; j < table.values.k; ++j) {
    std::vector<std::vector<double>> values;
    for (std::size_t g = 0; g < table.groups; ++g) {
      values.push_back(table.cell(g, j));
      found.cells.push_back({g, j, mean_interval(values[g]), median_of(values[g]), shapiro_wilk(values[g])});
    }
    for (std::size_t a = 0; a < table.groups; ++a)
      for (std::size_t b = a + 1; b < table.groups; ++b)
        found.pairs.push_back({a, b, j, welch_t(values[a], values[b]), 0, mann_whitney(values[a], values[b]), 0});
  }
  correct_pairs(found.pairs);
  return found;
}

}  // namespace jnd
