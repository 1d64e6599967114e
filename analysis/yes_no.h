// d' of the yes-no model, as Chinello et al. 2017 (section 5.1.3) compute it: d' = z(H) - z(F).
#pragma once

#include <string_view>

#include "analysis/counts.h"

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
  double dprime;     // zH - zF
  double criterion;  // c = -(zH + zF) / 2; positive: tends to say "same"
};

YesNo yes_no(const Counts& counts, Correction correction) noexcept;

}  // namespace jnd
