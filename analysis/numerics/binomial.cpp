#include "analysis/numerics/binomial.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace jnd {

namespace {

constexpr double kNegligible = 1e-30;  // of the largest probability

std::uint64_t in_units_of_slot(double share) noexcept {
  if (share >= 1) return std::numeric_limits<std::uint64_t>::max();
  return static_cast<std::uint64_t>(std::ldexp(std::max(share, 0.0), 64));
}

}  // namespace

BinomialTable binomial_table(int n, double p) {
  if (p <= 0) return {0, {1}};
  if (p >= 1) return {n, {1}};
  // From the most probable number outwards, by the ratio of neighbours: no factorial, no logarithm, the same
  // everywhere.
  const int mode = std::min(n, static_cast<int>((n + 1) * p));
  const double odds = p / (1 - p);
  std::vector<double> below, above{1};
  for (int k = mode; k > 0; --k) {
    const double next = (below.empty() ? 1 : below.back()) * k / ((n - k + 1) * odds);
    if (next < kNegligible) break;
    below.push_back(next);
  }
  for (int k = mode; k < n; ++k) {
    const double next = above.back() * (n - k) * odds / (k + 1);
    if (next < kNegligible) break;
    above.push_back(next);
  }
  BinomialTable table{mode - static_cast<int>(below.size()), {below.rbegin(), below.rend()}};
  table.probability.insert(table.probability.end(), above.begin(), above.end());
  const double sum = std::accumulate(table.probability.begin(), table.probability.end(), 0.0);
  for (double& probability : table.probability) probability /= sum;
  return table;
}

AliasTable::AliasTable(std::span<const double> probability) : slots_(probability.size()) {
  const double sum = std::accumulate(probability.begin(), probability.end(), 0.0);
  const auto size = static_cast<double>(probability.size());
  std::vector<double> share;
  std::vector<std::size_t> small, large;
  for (std::size_t i = 0; i < probability.size(); ++i) {
    share.push_back(probability[i] * size / sum);
    (share.back() < 1 ? small : large).push_back(i);
    slots_[i] = {std::numeric_limits<std::uint64_t>::max(), i};
  }
  while (!small.empty() && !large.empty()) {
    const std::size_t poor = small.back(), rich = large.back();
    small.pop_back();
    slots_[poor] = {in_units_of_slot(share[poor]), rich};
    share[rich] -= 1 - share[poor];
    if (share[rich] < 1) {
      large.pop_back();
      small.push_back(rich);
    }
  }
}

}  // namespace jnd
