// Logarithms of the normal distribution that stay exact where Phi itself underflows.
#pragma once

namespace jnd {

// log Phi(z) and the inverse Mills ratio phi(z) / Phi(z) = d log Phi / dz, relative error below 1e-13 for every finite
// z. Below z = -25 by the asymptotic series (Abramowitz and Stegun 26.2.12).
struct LogNormalCdf {
  double log_cdf = 0;
  double inverse_mills = 0;
};
LogNormalCdf log_normal_cdf(double z) noexcept;

double log_normal_density(double z) noexcept;  // log phi(z)

}  // namespace jnd
