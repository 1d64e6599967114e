// A proportion with the exact binomial interval of Clopper and Pearson.
//
// Source: Clopper and Pearson 1934, Biometrika 26, 404-413; its bounds as quantiles of the beta distribution, by
// Boost.Math's inverse of the incomplete beta function. Accuracy: 1e-12. Tests: closed forms at k = 0 and k = n,
// R 4.2.2 (binom.test).
#pragma once

namespace jnd {

struct ExactProportion {
  int k = 0, n = 0;
  double share = 0;                // k / n; NaN for n = 0
  double ci_low = 0, ci_high = 0;  // covers at least `confidence`; 0 .. 1 for n = 0
};
ExactProportion exact_proportion(int k, int n, double confidence = 0.95);  // 0 <= k <= n; confidence in 0..1

// Two-sided exact p of k of n against the rate p, 0 < p < 1: twice the smaller tail, so that it is below .05 just where p lies
// outside the interval above. (binom.test of R adds up the outcomes that are no likelier, and its p and interval can disagree.)
// 1 for n = 0.
double binomial_exact_p(int k, int n, double p);

}  // namespace jnd
