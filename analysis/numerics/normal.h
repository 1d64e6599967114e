// The standard normal distribution.
//
// Source: Boost.Math erfc and erfc_inv (relative error below 1e-15 over the whole range used here).
#pragma once

namespace jnd {

double normal_density(double z) noexcept;  // phi(z); z finite or infinite
double normal_cdf(double z) noexcept;      // Phi(z)
// z with Phi(z) = p. p = 0 gives -inf, p = 1 gives +inf; outside 0..1 NaN.
double normal_quantile(double p) noexcept;

}  // namespace jnd
