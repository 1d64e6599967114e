#include "analysis/numerics/tail_probabilities.h"

#include <cmath>

#include <boost/math/constants/constants.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/special_functions/beta.hpp>
#include <boost/math/special_functions/gamma.hpp>

#include "analysis/numerics/boost_policy.h"
#include "analysis/numerics/normal.h"
#include "analysis/numerics/special_values.h"

namespace jnd {

double student_t_two_sided(double t, double df) noexcept {
  if (std::isnan(t) || !(df > 0)) return kNaN;
  t = std::abs(t);
  if (std::isinf(t)) return 0;
  if (std::isinf(df)) return 2 * normal_cdf(-t);
  // The closed form of Cauchy; Boost's own is 1 - I and loses half the digits near t = 0.
  if (df == 1) return 2 * boost::math::constants::one_div_pi<double>() * std::atan(1 / t);
  // P = I_x(df/2, 1/2) with x = df / (df + t^2); the complement where x would round to 1.
  const double ratio = t / std::sqrt(df);
  // Where t^2 would leave the range of double, the first term of the series is all there is.
  if (ratio > 1e100) return 2 / (df * boost::math::beta(df / 2, 0.5, QuietPolicy())) * std::exp(-df * std::log(ratio));
  const double squared = ratio * ratio;
  if (squared < 1) return boost::math::ibetac(0.5, df / 2, squared / (1 + squared), QuietPolicy());
  return boost::math::ibeta(df / 2, 0.5, 1 / (1 + squared), QuietPolicy());
}

double student_t_quantile_two_sided(double p, double df) noexcept {
  if (!(p >= 0 && p <= 1) || !(df > 0)) return kNaN;
  if (p == 0) return kInf;
  if (p == 1) return 0;
  if (std::isinf(df)) return -normal_quantile(p / 2);
  const boost::math::students_t_distribution<double, QuietPolicy> student(df);
  return std::abs(boost::math::quantile(student, p / 2));
}

double f_upper(double f, double df1, double df2) noexcept {
  if (std::isnan(f) || !(df1 > 0) || !(df2 > 0)) return kNaN;
  if (f <= 0) return 1;
  if (std::isinf(f)) return 0;
  if (df1 == 1) return student_t_two_sided(std::sqrt(f), df2);
  const double ratio = f * (df1 / df2);
  if (std::isinf(ratio)) return 0;
  if (ratio > 1) return boost::math::ibeta(df2 / 2, df1 / 2, 1 / (1 + ratio), QuietPolicy());
  return boost::math::ibetac(df1 / 2, df2 / 2, ratio / (1 + ratio), QuietPolicy());
}

double chi2_upper(double chi2, double df) noexcept {
  if (std::isnan(chi2) || !(df > 0)) return kNaN;
  if (chi2 <= 0) return 1;
  if (std::isinf(chi2)) return 0;
  return boost::math::gamma_q(df / 2, chi2 / 2, QuietPolicy());
}

}  // namespace jnd
