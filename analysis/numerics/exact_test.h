// Exact two-sided tests of rates: the probability of all outcomes that are no likelier than the one at hand, as
// fisher.test and binom.test of R define it.
#pragma once

namespace jnd {

// Equal rates behind k1 of n1 and k2 of n2, given the margins (Fisher 1935). 0 <= k <= n. 1 where n1 or n2 is 0.
double fisher_exact_p(int k1, int n1, int k2, int n2);

// k of n against the rate p, 0 < p < 1 (Clopper and Pearson's setting). 1 for n = 0.
double binomial_exact_p(int k, int n, double p);

}  // namespace jnd
