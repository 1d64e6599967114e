#include "analysis/choice/choice_rates.h"

#include <cmath>
#include <numbers>

#include "analysis/choice/choice_task.h"
#include "analysis/detection/yes_no_profile.h"
#include "analysis/numerics/normal.h"
#include "analysis/numerics/special_values.h"

namespace jnd {

namespace {

struct BothStrategies {
  double differencing, independent;
};

BothStrategies dprime_of_difference(RatesTask task, double zd) noexcept {
  if (std::isnan(zd)) return {kNaN, kNaN};
  if (task == RatesTask::reminder_one_interval) return {std::numbers::sqrt2 * zd, zd};
  if (task == RatesTask::reminder_two_intervals) return {zd / std::numbers::sqrt2, zd / std::numbers::sqrt2};
  const double correct = normal_cdf(0.5 * zd), wrong = normal_cdf(-0.5 * zd);
  return {choice_dprime(ChoiceTask::abx_differencing, correct, wrong),
          choice_dprime(ChoiceTask::abx_independent, correct, wrong)};
}

TwoRates two_rates(RatesTask task, const YesNo& rates) noexcept {
  const BothStrategies dprime = dprime_of_difference(task, rates.dprime);
  const double unbiased = task == RatesTask::reminder_one_interval ? kNaN : normal_cdf(0.5 * rates.dprime);
  return {rates.hit_rate, rates.false_alarm_rate, rates.dprime, unbiased, dprime.differencing, dprime.independent};
}

}  // namespace

RatesDprime dprime_of_rates(RatesTask task, const Counts& counts) noexcept {
  const YesNo raw = yes_no(counts, Correction::none), loglinear = yes_no(counts, Correction::loglinear);
  const DprimeProfile profile = yes_no_profile(counts);
  const BothStrategies low = dprime_of_difference(task, profile.ci_low);
  const BothStrategies high = dprime_of_difference(task, profile.ci_high);
  RatesDprime result;
  result.status = raw.status;
  result.counts = counts;
  result.raw = two_rates(task, raw);
  result.loglinear = two_rates(task, loglinear);
  result.se_z_difference = loglinear.se;
  result.z_difference_low = profile.ci_low;
  result.z_difference_high = profile.ci_high;
  result.differencing_low = low.differencing;
  result.differencing_high = high.differencing;
  result.independent_low = low.independent;
  result.independent_high = high.independent;
  return result;
}

}  // namespace jnd
