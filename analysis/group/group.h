// Group statistics of JNDs: no participant is dropped silently.
#pragma once

#include <span>

#include "analysis/thresholds/jnd.h"

namespace jnd {

struct MeanEstimate {
  int n = 0;                       // used
  double mean = 0;                 // NaN for n = 0
  double sd = 0;                   // n - 1 in the denominator; NaN for n < 2
  double ci_low = 0, ci_high = 0;  // 95 %, Student t; NaN for n < 2
};
MeanEstimate mean_with_ci(std::span<const double> values);

// 1/m has no finite mean, so the mean of the JNDs stands beside three numbers that survive small m.
struct JndGroup {
  int n = 0;              // participants with a row in this condition (N)
  MeanEstimate mean_jnd;  // over status ok (the paper's number)
  MeanEstimate mean_weber;
  // no_sensitivity counts as +inf, ceiling as smaller than any JND; no_information is left out. The status says what
  // stands in the middle: ok; no_sensitivity (median_jnd is +inf); ceiling, or no_information where no participant is
  // in it (median_jnd is NaN).
  JndStatus median_status = JndStatus::no_information;
  double median_jnd = 0;
  int median_n = 0;
  MeanEstimate mean_log_jnd;      // of ln(JND / N/m), over status ok
  double inverse_mean_slope = 0;  // 1 / mean(m) over everyone with finite m; NaN where mean(m) <= 1e-9
  int slope_n = 0;
  int no_sensitivity = 0, ceiling = 0, no_information = 0;
};
JndGroup jnd_group(std::span<const JndEstimate> estimates);

}  // namespace jnd
