#include "analysis/behaviour/drift.h"

#include <cmath>

#include "analysis/numerics/normal.h"
#include "analysis/numerics/special_values.h"
#include "analysis/thresholds/jnd.h"

namespace jnd {

namespace {

HalfDifference compare(double first, double second, double variance) {
  HalfDifference result;
  result.first = first;
  result.second = second;
  result.difference = second - first;
  result.se = std::sqrt(variance);
  result.ci_low = result.difference - kNormal975 * result.se;
  result.ci_high = result.difference + kNormal975 * result.se;
  result.p = 2 * normal_cdf(-std::abs(result.difference / result.se));
  return result;
}

}  // namespace

Drift drift(const Counts& first, const Counts& second) {
  Drift result;
  result.first = first;
  result.second = second;
  const YesNo before = yes_no(first, Correction::loglinear), after = yes_no(second, Correction::loglinear);
  if (before.status == RateStatus::missing || after.status == RateStatus::missing) {
    result.status = RateStatus::missing;
    result.dprime = compare(before.dprime, after.dprime, kNaN);
    result.criterion = compare(before.criterion, after.criterion, kNaN);
    return result;
  }
  result.status = before.status == RateStatus::ok ? after.status : before.status;
  const double variance = loglinear_variance(first) + loglinear_variance(second);
  result.dprime = compare(before.dprime, after.dprime, variance);
  result.criterion = compare(before.criterion, after.criterion, variance / 4);
  if (result.status != RateStatus::ok) result.dprime.p = result.criterion.p = kNaN;
  return result;
}

Drift drift(std::span<const JudgedTrial> trials) {
  std::vector<JudgedTrial> first, second;
  for (const JudgedTrial& trial : trials) (trial.time_fraction < 0.5 ? first : second).push_back(trial);
  return drift(counts_of(first), counts_of(second));
}

StratifiedDrift stratified_drift(std::span<const Drift> strata) {
  StratifiedDrift result;
  double sum = 0, weights = 0;
  for (const Drift& one : strata) {
    if (one.status == RateStatus::missing) continue;
    const double weight = 1 / (one.dprime.se * one.dprime.se);
    sum += weight * one.dprime.difference;
    weights += weight;
    ++result.strata;
  }
  result.difference = result.strata > 0 ? sum / weights : kNaN;
  result.se = result.strata > 0 ? 1 / std::sqrt(weights) : kNaN;
  result.ci_low = result.difference - kNormal975 * result.se;
  result.ci_high = result.difference + kNormal975 * result.se;
  result.p = result.strata > 0 ? 2 * normal_cdf(-std::abs(result.difference / result.se)) : kNaN;
  return result;
}

}  // namespace jnd
