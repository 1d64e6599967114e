// d' of the yes-no model, as Chinello et al. 2017 (section 5.1.3) compute it: d' = z(H) - z(F), with its standard
// error.
//
// Standard error: Gourevitch and Galanter 1967, Psychometrika 32:25,
//   var = H (1 - H) / (n_diff phi(zH)^2) + F (1 - F) / (n_same phi(zF)^2),
// with the corrected rates and the raw numbers of trials. The Wald interval d' -+ 1.96 se is too narrow in small
// samples and has none at a rate of 0 or 1; dprime_intervals.h has a better one.
#pragma once

#include <string_view>

#include "analysis/detection/counts.h"

namespace jnd {

enum class RateStatus {
  ok,
  no_information,  // every answer was "same", or every answer was "different"
  missing          // no trial of one class: nothing can be estimated
};
std::string_view to_string(RateStatus status) noexcept;

struct YesNo {
  RateStatus status = RateStatus::missing;
  Correction correction = Correction::loglinear;
  // Raw rates, and the corrected rates with their z scores. NaN under `missing`; z and d' may be infinite or NaN under
  // Correction::none (inf - inf). Writers turn NaN into null or an empty cell.
  double raw_hit_rate, raw_false_alarm_rate;
  double hit_rate, false_alarm_rate;
  double z_hit, z_false_alarm;
  double dprime;           // zH - zF
  double criterion;        // c = -(zH + zF) / 2; positive: tends to say "same"
  double ln_beta;          // log likelihood ratio at the criterion, (zF^2 - zH^2) / 2 = c d'
  double se;               // of d'; NaN, as the interval, where a rate is 0 or 1 (under `none`)
  double ci_low, ci_high;  // Wald, 95 %
};

YesNo yes_no(const Counts& counts, Correction correction) noexcept;

}  // namespace jnd
