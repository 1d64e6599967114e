// Three functions for long tables: the same results as the exact ones to about 1e-14, many times as fast, and the same
// bits on every processor.
#pragma once

#include <span>

namespace jnd {

// ln Phi(z), absolute error below 1e-14 or relative below 1e-13: Taylor's polynomial about the nearest of fixed places.
double tabled_log_normal_cdf(double z) noexcept;
// found[i] = the same of z[i].
void log_normal_cdfs(std::span<const double> z, double* found) noexcept;

// values[i] = e^(values[i] - less), relative error below 1e-14, for exponents of at most 1; 0 below e^-700.
void exponentiate(std::span<double> values, double less) noexcept;

// values[i] = ln values[i], relative error below 1e-15, of positive numbers of full precision.
void take_logarithms(std::span<double> values) noexcept;

}  // namespace jnd
