// Tests by ranks within participants. Friedman's: do conditions differ, by ranks within each participant?
//
// Source: Friedman 1937 with the correction for ties, as R 4.2.2's friedman.test; Kendall's W = chi2 / (n (k - 1));
// Iman and Davenport 1980, Communications in Statistics A9, 571-595, for the F form, which is less conservative.
// Values of a participant tie where they are equal as the decimals that were read (decimal_order.h).
// Accuracy: closed forms, 1e-12. Tests: R 4.2.2.
#pragma once

#include <span>
#include <vector>

#include "analysis/group/within_table.h"
#include "analysis/numerics/statistic_status.h"

namespace jnd {

struct Friedman {
  int n = 0;
  double chi2 = 0;
  int df = 0;  // k - 1
  double p = 0;
  double kendall_w = 0;                               // 0..1
  double f_iman_davenport = 0, p_iman_davenport = 0;  // inf and 0 where all rank alike
  StatisticStatus status = StatisticStatus::ok;       // else too_few (n < 2 or k < 2), no_variance (all tied)
};
Friedman friedman(const WithinTable& table);

// Wilcoxon's signed-rank test of paired values.
//
// Source: Wilcoxon 1945; conventions of R 4.2.2's wilcox.test(x, y, paired = TRUE): zero differences are dropped; exact
// where fewer than 50 differences are left and there are no ties and no zeros; else the normal approximation with the
// corrections for continuity (0.5) and ties (sum of (t^3 - t)/48 off the variance). Pratt 1959 for keeping the zeros.
// Beside it the exact permutation p with midranks (all 2^n sign changes, counted by dynamic programming), which stays
// right where ratings tie. Ties and zeros are those of the differences of the decimals that were read
// (decimal_order.h): 5.50 - 5.45 ties with 5.40 - 5.35, which R has only with digits.rank.
// Accuracy: exact p 1e-13 relative. Tests: R 4.2.2, exactRankTests, coin; direct enumeration.

// The largest number of non-zero differences for which the exact permutation p is computed.
inline constexpr int kLargestExactSignedRank = 200;

struct SignedRank {
  int n = 0;                       // pairs
  int zeros = 0;                   // of them with x == y
  bool ties = false;               // among the absolute non-zero differences
  double v = 0;                    // sum of the ranks of the positive differences x - y
  double p = 0;                    // two-sided, as R: exact or normal
  bool exact = false;              // which of the two p is
  double p_normal = 0;             // continuity and tie correction, whatever n
  double p_exact_permutation = 0;  // two-sided; NaN for more than kLargestExactSignedRank differences
  double rank_biserial = 0;        // (V - V-) / (V + V-), -1..1; zeros dropped
  StatisticStatus status =
      StatisticStatus::ok;  // else too_few (no pair), no_variance (every difference is 0): all but v are NaN
};
SignedRank signed_rank(std::span<const double> x, std::span<const double> y);  // of equal size
SignedRank signed_rank(std::span<const double> differences);                   // where these are what was read

// Pratt's way: the zeros take part in the ranking and are dropped afterwards. z without continuity correction.
struct PrattSignedRank {
  double z = 0, p = 0;             // two-sided, normal
  double p_exact_permutation = 0;  // as above
  StatisticStatus status = StatisticStatus::ok;
};
PrattSignedRank pratt_signed_rank(std::span<const double> x, std::span<const double> y);  // of equal size
PrattSignedRank pratt_signed_rank(std::span<const double> differences);

}  // namespace jnd
