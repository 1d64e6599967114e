#include "analysis/numerics/normal.h"

#include <cmath>
#include <limits>

#include <boost/math/constants/constants.hpp>
#include <boost/math/special_functions/erf.hpp>

namespace jnd {

namespace {
// Never throws and never sets errno: the edges are handled before the call. No promotion to long double, so that the
// same bits come out on machines with and without it.
using Policy =
    boost::math::policies::policy<boost::math::policies::promote_double<false>,
                                  boost::math::policies::domain_error<boost::math::policies::ignore_error>,
                                  boost::math::policies::overflow_error<boost::math::policies::ignore_error>,
                                  boost::math::policies::evaluation_error<boost::math::policies::ignore_error>>;
}  // namespace

double normal_density(double z) noexcept {
  return boost::math::constants::one_div_root_two_pi<double>() * std::exp(-0.5 * z * z);
}

double normal_cdf(double z) noexcept {
  if (std::isinf(z)) return z > 0 ? 1.0 : 0.0;
  return 0.5 * boost::math::erfc(-z * boost::math::constants::one_div_root_two<double>(), Policy());
}

double normal_quantile(double p) noexcept {
  if (!(p >= 0.0 && p <= 1.0)) return std::numeric_limits<double>::quiet_NaN();
  if (p == 0.0) return -std::numeric_limits<double>::infinity();
  if (p == 1.0) return std::numeric_limits<double>::infinity();
  return -boost::math::constants::root_two<double>() * boost::math::erfc_inv(2.0 * p, Policy());
}

}  // namespace jnd
