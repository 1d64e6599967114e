#include "analysis/numerics/binomial.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <boost/math/special_functions/beta.hpp>

#include "analysis/numerics/special_values.h"

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

BinomialSampler::BinomialSampler(int n, double p) {
  constexpr double kNegligible = 1e-20;
  if (p <= 0 || p >= 1 || n == 0) {
    first_ = p >= 1 ? n : 0;
    cumulative_ = {1};
    return;
  }
  const double odds = p / (1 - p);
  const int mode = std::min(n, static_cast<int>(std::floor((n + 1.0) * p)));
  std::vector<double> down, up = {1};  // relative to the mode
  for (int k = mode; k > 0; --k) {
    const double next = (down.empty() ? 1 : down.back()) * k / ((n - k + 1.0) * odds);
    if (next < kNegligible) break;
    down.push_back(next);
  }
  for (int k = mode; k < n; ++k) {
    const double next = up.back() * (n - k) / (k + 1.0) * odds;
    if (next < kNegligible) break;
    up.push_back(next);
  }
  first_ = mode - static_cast<int>(down.size());
  cumulative_.assign(down.rbegin(), down.rend());
  cumulative_.insert(cumulative_.end(), up.begin(), up.end());
  double sum = 0;
  for (double& value : cumulative_) value = sum += value;
  for (double& value : cumulative_) value /= sum;
}

int BinomialSampler::at(double u) const noexcept {
  const auto place = std::lower_bound(cumulative_.begin(), cumulative_.end() - 1, u);
  return first_ + static_cast<int>(place - cumulative_.begin());
}

double open_uniform(std::mt19937_64& generator) {
  return open_uniform(std::uint64_t{generator()});
}

double open_uniform(std::uint64_t bits) {
  return (static_cast<double>(bits >> 11U) + 0.5) * 0x1p-53;
}

ExactProportion exact_proportion(int k, int n, double confidence) {
  ExactProportion result{.k = k, .n = n, .share = 0, .ci_low = 0, .ci_high = 1};
  result.share = n > 0 ? static_cast<double>(k) / n : kNaN;
  const double tail = (1 - confidence) / 2;
  if (k > 0) result.ci_low = boost::math::ibeta_inv(k, n - k + 1.0, tail);
  if (k < n) result.ci_high = boost::math::ibetac_inv(k + 1.0, n - k, tail);
  return result;
}

double binomial_exact_p(int k, int n, double p) {
  const double at_most = k < n ? boost::math::ibetac(k + 1.0, n - k, p) : 1;
  const double at_least = k > 0 ? boost::math::ibeta(k, n - k + 1.0, p) : 1;
  return std::min(1.0, 2 * std::min(at_most, at_least));
}

}  // namespace jnd
