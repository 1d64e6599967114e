// The standard normal distribution.
//
// Source: Boost.Math erfc and erfc_inv (relative error below 1e-15 over the whole range used here).
#pragma once

namespace jnd {

double normal_density(double z) noexcept;  // phi(z); z finite or infinite
double normal_cdf(double z) noexcept;      // Phi(z)
// z with Phi(z) = p. p = 0 gives -inf, p = 1 gives +inf; outside 0..1 NaN.
double normal_quantile(double p) noexcept;

inline constexpr double kNormal975 = 1.959963984540054;  // the 97.5 % quantile, of 95 % intervals

// Logarithms of the normal distribution that stay exact where Phi itself underflows.
// log Phi(z) and the inverse Mills ratio phi(z) / Phi(z) = d log Phi / dz, relative error below 1e-13 for every finite
// z. Below z = -25 by the asymptotic series (Abramowitz and Stegun 26.2.12).
struct LogNormalCdf {
  double log_cdf = 0;
  double inverse_mills = 0;
};
LogNormalCdf log_normal_cdf(double z) noexcept;

double log_normal_density(double z) noexcept;  // log phi(z)

}  // namespace jnd
