// Tail probabilities of Student's t, F and chi squared: computed as tails, so that a tiny p keeps its digits.
//
// Source: Boost.Math incomplete beta and gamma functions. Accuracy: 1e-13 relative.
// Tests: closed forms at 1, 2 and 4 degrees of freedom down to 1e-280; the p values of R 4.2.2 in the tests that use
// them.
#pragma once

#include <algorithm>

namespace jnd {

double student_t_two_sided(double t, double df) noexcept;  // P(|t_df| > |t|); df > 0, may be infinite
// t > 0 with P(|t_df| > t) = p; p in 0..1 (0: inf).
double student_t_quantile_two_sided(double p, double df) noexcept;
double f_upper(double f, double df1, double df2) noexcept;  // P(F > f); df need not be whole; f <= 0 gives 1
double chi2_upper(double chi2, double df) noexcept;         // P(X > chi2); chi2 <= 0 gives 1

// Whether counts are large enough for the chi-square p of a deviance. With one trial per level the deviance of the true
// function does not follow chi-square at all; with few, or where nearly all answers are alike, not closely. Source:
// McCullagh and Nelder 1989, section 4.4.
struct CountsPerLevel {
  double levels = 0, trials = 0, rarer = 0;  // rarer: answers of the word that a level has fewer of

  void add(double n, double k) noexcept {
    ++levels;
    trials += n;
    rarer += std::min(k, n - k);
  }
  // True: fewer than 5 trials per level on average, or fewer than 1 of the rarer answer.
  bool too_few() const noexcept { return trials < 5 * levels || rarer < levels; }
};

}  // namespace jnd
