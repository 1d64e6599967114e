#include "analysis/numerics/binomial_sampler.h"

#include <algorithm>
#include <cmath>

namespace jnd {

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

}  // namespace jnd
