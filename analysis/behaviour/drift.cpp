#include "analysis/behaviour/drift.h"

#include <array>
#include <cmath>

#include <boost/math/special_functions/gamma.hpp>

#include "analysis/numerics/normal.h"
#include "analysis/numerics/special_values.h"
#include "analysis/thresholds/jnd_closed.h"
#include "analysis/thresholds/jnd_ml.h"

namespace jnd {

namespace {

// Upper tail of chi-square with 1 degree of freedom at twice a difference of log-likelihoods; rounding may make it
// negative.
double likelihood_ratio_p(double half_statistic) {
  return boost::math::gamma_q(0.5, std::fmax(0, half_statistic));
}

// Of one d' in both halves, with a criterion each, against a rate for every cell: the joint likelihood of two series
// with the same difference.
double equal_dprime_p(const Counts& first, const Counts& second) {
  std::array<SeriesCounts, 2> halves;
  halves[0].counts = first;
  halves[1].counts = second;
  for (SeriesCounts& half : halves) half.difference = 1;
  const double saturated = saturated_log_likelihood(ml_groups(halves, false));
  return likelihood_ratio_p(saturated - ml_point(halves, JndMethod::ml_yes_no_series).log_likelihood);
}

// With H = Phi(d/2 - c) and 1 - F = Phi(d/2 + c), the criterion is to d' what d' is to the criterion: correct answers
// to equal pairs take the place of hits, and hits that of false alarms.
Counts exchanged(const Counts& counts) noexcept {
  Counts other;
  other.n_diff = counts.n_same;
  other.hits = counts.n_same - counts.false_alarms;
  other.n_same = counts.n_diff;
  other.false_alarms = counts.hits;
  return other;
}

HalfDifference compare(double first, double second, double variance) {
  HalfDifference result;
  result.first = first;
  result.second = second;
  result.difference = second - first;
  result.se = std::sqrt(variance);
  result.ci_low = result.difference - kNormal975 * result.se;
  result.ci_high = result.difference + kNormal975 * result.se;
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
    result.dprime.p = result.criterion.p = kNaN;
    return result;
  }
  result.status = before.status == RateStatus::ok ? after.status : before.status;
  const double variance = loglinear_variance(first) + loglinear_variance(second);
  result.dprime = compare(before.dprime, after.dprime, variance);
  result.dprime.p = equal_dprime_p(first, second);
  result.criterion = compare(before.criterion, after.criterion, variance / 4);
  result.criterion.p = equal_dprime_p(exchanged(first), exchanged(second));
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
