#include "analysis/group/rank_tests.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>

#include "analysis/numerics/decimal_order.h"
#include "analysis/numerics/normal.h"
#include "analysis/numerics/ranks.h"
#include "analysis/numerics/special_values.h"
#include "analysis/numerics/tail_probabilities.h"

namespace jnd {

namespace {

// P(S = s), s = 0..last, of the sum S of those of the whole numbers that independent fair coins choose. Each coin
// halves all probabilities and adds them shifted: nothing is subtracted, and up to 52 coins every value is exact.
std::vector<double> coin_sums(std::span<const int> numbers, int last) {
  std::vector<double> probability(static_cast<std::size_t>(last) + 1, 0.0);
  probability[0] = 1;
  int reached = 0;
  for (const int number : numbers) {
    reached = std::min(last, reached + number);
    for (int sum = reached; sum >= 0; --sum) {
      const auto at = static_cast<std::size_t>(sum);
      const double with = sum >= number ? probability[at - static_cast<std::size_t>(number)] : 0.0;
      probability[at] = 0.5 * (probability[at] + with);
    }
  }
  return probability;
}

// Two-sided: twice the smaller tail of the sum of ranks, both including the sum found. NaN for too many ranks.
double permutation_p(std::span<const double> ranks, double sum_found) {
  if (ranks.size() > static_cast<std::size_t>(kLargestExactSignedRank)) return kNaN;
  bool whole = true;
  double total = 0;
  for (const double rank : ranks) {
    whole = whole && rank == std::floor(rank);
    total += rank;
  }
  const double unit = whole ? 1 : 2;  // midranks are halves
  std::vector<int> numbers;
  for (const double rank : ranks) numbers.push_back(static_cast<int>(unit * rank));
  // The distribution is symmetric about total/2, so that the lower tail serves for both.
  const int end = static_cast<int>(unit * std::min(sum_found, total - sum_found));
  double tail = 0;
  for (const double probability : coin_sums(numbers, end)) tail += probability;
  return std::min(1.0, 2 * tail);
}

// places: of the differences, as decimal_difference_places() has them.
SignedRank signed_rank_of(std::span<const int> places) {
  SignedRank result;
  result.n = static_cast<int>(places.size());
  std::vector<int> sizes;
  std::vector<bool> positive;
  for (const int place : places) {
    if (place == 0) continue;
    sizes.push_back(std::abs(place));
    positive.push_back(place > 0);
  }
  result.zeros = result.n - static_cast<int>(sizes.size());
  result.p = result.p_normal = result.p_exact_permutation = result.rank_biserial = kNaN;
  if (sizes.empty()) {
    result.status = places.empty() ? StatisticStatus::too_few : StatisticStatus::no_variance;
    return result;
  }
  const Ranks ranks = midranks_of_places(sizes);
  result.ties = ranks.tie_sum > 0;
  for (std::size_t i = 0; i < sizes.size(); ++i)
    if (positive[i]) result.v += ranks.ranks[i];
  const auto n = static_cast<double>(sizes.size());
  const double total = n * (n + 1) / 2;
  result.rank_biserial = (2 * result.v - total) / total;

  const double off = std::abs(result.v - total / 2);
  const double sd = std::sqrt(n * (n + 1) * (2 * n + 1) / 24 - ranks.tie_sum / 48);
  result.p_normal = std::min(1.0, 2 * normal_cdf(-std::max(0.0, off - 0.5) / sd));
  result.p_exact_permutation = permutation_p(ranks.ranks, result.v);
  result.exact = n < 50 && !result.ties && result.zeros == 0;
  result.p = result.exact ? result.p_exact_permutation : result.p_normal;
  return result;
}

PrattSignedRank pratt_of(std::span<const int> places) {
  PrattSignedRank result;
  result.z = result.p = result.p_exact_permutation = kNaN;
  std::vector<int> sizes;
  for (const int place : places) sizes.push_back(std::abs(place));
  const Ranks ranks = midranks_of_places(sizes);
  std::vector<double> used;
  double v = 0, total = 0, squares = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (places[i] == 0) continue;
    used.push_back(ranks.ranks[i]);
    total += ranks.ranks[i];
    squares += ranks.ranks[i] * ranks.ranks[i];
    if (places[i] > 0) v += ranks.ranks[i];
  }
  if (used.empty()) {
    result.status = places.empty() ? StatisticStatus::too_few : StatisticStatus::no_variance;
    return result;
  }
  result.z = (v - total / 2) / std::sqrt(squares / 4);
  result.p = 2 * normal_cdf(-std::abs(result.z));
  result.p_exact_permutation = permutation_p(used, v);
  return result;
}

std::vector<int> places_of(std::span<const double> differences) {
  return decimal_difference_places(differences, std::vector<double>(differences.size(), 0.0));
}

}  // namespace

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

SignedRank signed_rank(std::span<const double> x, std::span<const double> y) {
  return signed_rank_of(decimal_difference_places(x, y));
}

SignedRank signed_rank(std::span<const double> differences) {
  return signed_rank_of(places_of(differences));
}

PrattSignedRank pratt_signed_rank(std::span<const double> x, std::span<const double> y) {
  return pratt_of(decimal_difference_places(x, y));
}

PrattSignedRank pratt_signed_rank(std::span<const double> differences) {
  return pratt_of(places_of(differences));
}

}  // namespace jnd
