// Exact statistics of rates: a proportion with its interval, and tests.
//
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

// Exact two-sided tests of rates: the probability of all outcomes that are no likelier than the one at hand, as
// fisher.test and binom.test of R define it.
// Equal rates behind k1 of n1 and k2 of n2, given the margins (Fisher 1935). 0 <= k <= n. 1 where n1 or n2 is 0.
double fisher_exact_p(int k1, int n1, int k2, int n2);

// k of n against the rate p, 0 < p < 1 (Clopper and Pearson's setting). 1 for n = 0.
double binomial_exact_p(int k, int n, double p);

}  // namespace jnd
