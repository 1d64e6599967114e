#include "analysis/numerics/exact_proportion.h"

#include <algorithm>

#include <boost/math/special_functions/beta.hpp>

#include "analysis/numerics/special_values.h"

namespace jnd {

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
