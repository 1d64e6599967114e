#include "analysis/numerics/exact_proportion.h"

#include <limits>

#include <boost/math/special_functions/beta.hpp>

namespace jnd {

ExactProportion exact_proportion(int k, int n, double confidence) {
  ExactProportion result{.k = k, .n = n, .share = 0, .ci_low = 0, .ci_high = 1};
  result.share = n > 0 ? static_cast<double>(k) / n : std::numeric_limits<double>::quiet_NaN();
  const double tail = (1 - confidence) / 2;
  if (k > 0) result.ci_low = boost::math::ibeta_inv(k, n - k + 1.0, tail);
  if (k < n) result.ci_high = boost::math::ibetac_inv(k + 1.0, n - k, tail);
  return result;
}

}  // namespace jnd
