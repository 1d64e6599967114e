#include "analysis/yes_no.h"

#include <limits>

#include "analysis/normal.h"

namespace jnd {

std::string_view to_string(RateStatus status) noexcept {
  switch (status) {
    case RateStatus::ok:
      return "ok";
    case RateStatus::no_information:
      return "no_information";
    case RateStatus::missing:
      return "missing";
  }
  return "";
}

YesNo yes_no(const Counts& counts, Correction correction) noexcept {
  YesNo result;
  result.correction = correction;
  if (counts.n_diff <= 0 || counts.n_same <= 0) {
    // Never a pseudo-value: the log-linear rate of 0 out of 0 would be 0.5, which looks like an observation.
    result.status = RateStatus::missing;
    result.raw_hit_rate = result.raw_false_alarm_rate = std::numeric_limits<double>::quiet_NaN();
    result.hit_rate = result.false_alarm_rate = std::numeric_limits<double>::quiet_NaN();
    result.z_hit = result.z_false_alarm = std::numeric_limits<double>::quiet_NaN();
    result.dprime = result.criterion = std::numeric_limits<double>::quiet_NaN();
    return result;
  }
  const int said_different = counts.hits + counts.false_alarms;
  const bool one_answer = said_different == 0 || said_different == counts.n_diff + counts.n_same;
  result.status = one_answer ? RateStatus::no_information : RateStatus::ok;
  result.raw_hit_rate = corrected_rate(counts.hits, counts.n_diff, Correction::none);
  result.raw_false_alarm_rate = corrected_rate(counts.false_alarms, counts.n_same, Correction::none);
  result.hit_rate = corrected_rate(counts.hits, counts.n_diff, correction);
  result.false_alarm_rate = corrected_rate(counts.false_alarms, counts.n_same, correction);
  result.z_hit = normal_quantile(result.hit_rate);
  result.z_false_alarm = normal_quantile(result.false_alarm_rate);
  result.dprime = result.z_hit - result.z_false_alarm;
  result.criterion = -0.5 * (result.z_hit + result.z_false_alarm);
  return result;
}

}  // namespace jnd
