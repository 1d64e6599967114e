// Tail probabilities of Student's t, F and chi squared: computed as tails, so that a tiny p keeps its digits.
//
// Source: Boost.Math incomplete beta and gamma functions. Accuracy: 1e-13 relative.
// Tests: closed forms at 1, 2 and 4 degrees of freedom down to 1e-280; the p values of R 4.2.2 in the tests that use
// them.
#pragma once

namespace jnd {

double student_t_two_sided(double t, double df) noexcept;  // P(|t_df| > |t|); df > 0, may be infinite
// t > 0 with P(|t_df| > t) = p; p in 0..1 (0: inf).
double student_t_quantile_two_sided(double p, double df) noexcept;
double f_upper(double f, double df1, double df2) noexcept;  // P(F > f); df need not be whole; f <= 0 gives 1
double chi2_upper(double chi2, double df) noexcept;         // P(X > chi2); chi2 <= 0 gives 1

}  // namespace jnd
