// Friedman's test: do conditions differ, by ranks within each participant?
//
// Source: Friedman 1937 with the correction for ties, as R 4.2.2's friedman.test; Kendall's W = chi2 / (n (k - 1));
// Iman and Davenport 1980, Communications in Statistics A9, 571-595, for the F form, which is less conservative.
// Values of a participant tie where they are equal as the decimals that were read (decimal_order.h).
// Accuracy: closed forms, 1e-12. Tests: R 4.2.2.
#pragma once

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

}  // namespace jnd
