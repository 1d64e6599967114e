#include "analysis/numerics/normal.h"

#include <cmath>

#include <boost/math/constants/constants.hpp>
#include <boost/math/special_functions/erf.hpp>

#include "analysis/numerics/boost_policy.h"
#include "analysis/numerics/special_values.h"

namespace jnd {

double normal_density(double z) noexcept {
  return boost::math::constants::one_div_root_two_pi<double>() * std::exp(-0.5 * z * z);
}

double normal_cdf(double z) noexcept {
  if (std::isinf(z)) return z > 0 ? 1.0 : 0.0;
  return 0.5 * boost::math::erfc(-z * boost::math::constants::one_div_root_two<double>(), QuietPolicy());
}

double normal_quantile(double p) noexcept {
  if (!(p >= 0.0 && p <= 1.0)) return kNaN;
  if (p == 0.0) return -kInf;
  if (p == 1.0) return kInf;
  return -boost::math::constants::root_two<double>() * boost::math::erfc_inv(2.0 * p, QuietPolicy());
}

namespace {
const double kLogRootTwoPi = 0.5 * std::log(boost::math::constants::two_pi<double>());
constexpr double kAsymptotic = -25;
}  // namespace

double log_normal_density(double z) noexcept {
  return -0.5 * z * z - kLogRootTwoPi;
}

LogNormalCdf log_normal_cdf(double z) noexcept {
  LogNormalCdf result;
  if (z < kAsymptotic) {
    // Phi(z) = phi(z)/|z| (1 - 1/z^2 + 3/z^4 - 15/z^6 + ...); the first term left out is below 1e-15 of the sum here.
    const double t = 1 / (z * z);
    const double series = 1 + t * (-1 + t * (3 + t * (-15 + t * (105 + t * (-945 + t * 10395)))));
    result.log_cdf = log_normal_density(z) - std::log(-z) + std::log(series);
    result.inverse_mills = -z / series;
    return result;
  }
  if (z > 0) {
    result.log_cdf = std::log1p(-normal_cdf(-z));
    result.inverse_mills = normal_density(z) / normal_cdf(z);
    return result;
  }
  const double cdf = normal_cdf(z);
  result.log_cdf = std::log(cdf);
  result.inverse_mills = normal_density(z) / cdf;
  return result;
}

}  // namespace jnd
