// The studentised range: (largest - smallest of `groups` standard normal means) / (independent s on df degrees).
//
// Source: Lund and Lund 1983, Applied Statistics 32, 204-210 (AS 190), for the definition. Computed anew, because AS
// 190 and its successors lose accuracy at few degrees of freedom:
//   groups = 2   Student's t: P(Q > q) = P(|t_df| > q / sqrt 2).
//   groups = 3   P(Q > q) = (6/pi) Int_0^{pi/6} (1 + q^2 / (2 df cos^2 x))^(-df/2) dx: the range of three is Owen's
//                12 T(w/sqrt 2, 1/sqrt 3), and the integral over s has a closed form under the sign of T's integral.
//   groups > 3   trapezoidal sums over ln s and over the smallest mean. Both integrands are analytic and die out at
//                both ends, where the rule converges exponentially wherever its nodes lie. So the nodes of all q and df
//                lie on common grids, and P(W > w) of the range W of `groups` normal values is computed once at each
//                and kept.
// Tails are summed, never subtracted from 1, so that a p of 1e-200 has as many digits as one of 0.1.
// Accuracy: p_upper 1e-12 relative; quantiles 1e-9 relative (an absolute 1e-15 of p near p_upper = 1 is all there is).
// Tests: exact values to 16 digits in arbitrary precision, df = 1..inf, down to p = 1e-127; closed forms at groups = 2,
// df = 1 and groups = 3, df = 2; tables of an independent implementation, 1e-12.
#pragma once

namespace jnd {

// P(Q > q). groups = 2..1000, df >= 1 (not necessarily whole; infinity allowed). q <= 0 gives 1, q = +inf gives 0.
// NaN outside these ranges.
double studentised_range_upper(double q, int groups, double df);

// q with P(Q > q) = p_upper. p_upper = 1 gives 0, 0 gives +inf; NaN outside 0..1 and outside the ranges above.
double studentised_range_quantile_upper(double p_upper, int groups, double df);

// q with P(Q <= q) = p, as R's qtukey.
double studentised_range_quantile(double p, int groups, double df);

}  // namespace jnd
