// Log-likelihoods of one or two binomial counts, without binomial constants, and their ratios without cancellation.
#pragma once

#include "analysis/detection/counts.h"

namespace jnd {

// k log(k/n) + (n - k) log((n - k)/n), the largest value over all rates; 0 <= k <= n, n >= 1. 0 where k is 0 or n.
double saturated_log_likelihood(int k, int n) noexcept;
// k log(rate) + (n - k) log(complement), complement = 1 - rate given apart so that no digit is lost near 1; 0 log 0 =
// 0.
double binomial_log_likelihood(int k, int n, double rate, double complement) noexcept;

// Of both classes: at their own rates, and at the pooled rate of "different".
double saturated_log_likelihood(const Counts& counts) noexcept;
double pooled_log_likelihood(const Counts& counts) noexcept;
// The difference of the two, >= 0, to full relative precision even where it is tiny: half the likelihood-ratio
// statistic of equal rates. Both classes have trials. (Sum over the four cells of the deviance term of Loader 2000.)
double half_deviance_of_equal_rates(const Counts& counts) noexcept;

// k log Phi(x) + (n - k) log Phi(-x) with its derivatives on x: concave in x. Safe for any finite x.
struct ProbitLikelihood {
  double value, slope, curvature;  // curvature <= 0
};
ProbitLikelihood probit_log_likelihood(int k, int n, double x) noexcept;

}  // namespace jnd
