#include "analysis/behaviour/judged_trial.h"

#include <algorithm>
#include <cmath>

#include "analysis/numerics/normal.h"
#include "analysis/numerics/special_values.h"

namespace jnd {

Counts counts_of(std::span<const JudgedTrial> trials) noexcept {
  Counts counts;
  for (const JudgedTrial& trial : trials) counts.add(trial.same, trial.said_different);
  return counts;
}

Share share_of(int k, int n) noexcept {
  Share share;
  share.k = k;
  share.n = n;
  if (n == 0) {
    share.value = share.ci_low = share.ci_high = kNaN;
    return share;
  }
  const double p = static_cast<double>(k) / n, z2 = kNormal975 * kNormal975;
  const double centre = (p + z2 / (2.0 * n)) / (1 + z2 / n);
  const double half = kNormal975 * std::sqrt(p * (1 - p) / n + z2 / (4.0 * n * n)) / (1 + z2 / n);
  share.value = p;
  // At k = 0 and k = n the bounds are 0 and 1, which rounding would miss by a hair.
  share.ci_low = k == 0 ? 0 : std::max(0.0, centre - half);
  share.ci_high = k == n ? 1 : std::min(1.0, centre + half);
  return share;
}

}  // namespace jnd
