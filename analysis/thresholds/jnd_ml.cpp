#include "analysis/thresholds/jnd_ml.h"

#include "analysis/numerics/normal.h"
#include "analysis/numerics/profile_interval.h"
#include "analysis/numerics/special_values.h"
#include "analysis/thresholds/jnd_ml_differencing.h"
#include "analysis/thresholds/jnd_ml_yes_no.h"
#include "analysis/thresholds/ml_cells.h"

namespace jnd {

namespace {

bool is_common(JndMethod method) noexcept {
  return method == JndMethod::ml_yes_no_common || method == JndMethod::ml_differencing_common;
}
bool is_differencing(JndMethod method) noexcept {
  return method == JndMethod::ml_differencing_common || method == JndMethod::ml_differencing_series;
}

double observed(const MlGroup& group, double x) noexcept {
  for (const MlCell& cell : group.cells)
    if (cell.x == x) return cell.said / cell.n;
  return kNaN;
}

// The rates that the fit gives each series. A group with its criterion or the slope at infinity is fitted by what was
// observed: its certain cells exactly, and the one difference with both answers by its rate.
template <typename Probability>
std::vector<MlSlope::Rates> fitted(std::span<const SeriesCounts> series, std::span<const MlGroup> groups, bool common,
                                   bool at_infinity, const Probability& probability) {
  std::vector<MlSlope::Rates> rates;
  for (std::size_t i = 0; i < series.size(); ++i) {
    const std::size_t place = common ? 0 : i;
    const MlGroup& group = groups[place];
    MlSlope::Rates one;
    if (at_infinity || group.all_alike) {
      one.different_pair = observed(group, series[i].difference);
      one.equal_pair = observed(group, 0);
    } else {
      one.different_pair = probability(place, series[i].difference);
      one.equal_pair = probability(place, 0.0);
    }
    rates.push_back(one);
  }
  return rates;
}

MlSlope yes_no_slope(std::span<const SeriesCounts> series, std::span<const MlGroup> groups, bool common,
                     bool with_interval) {
  YesNoProfile profile(groups);
  MlSlope fit;
  fit.ci_low = fit.ci_high = kNaN;
  const MlMaximum where = ml_maximum(groups);
  if (where == MlMaximum::finite) {
    fit.slope = profile.maximum();
    fit.log_likelihood = profile.at(fit.slope).value;
  } else {
    fit.slope = where == MlMaximum::at_plus_infinity ? kInf : -kInf;
    fit.log_likelihood = saturated_log_likelihood(groups);
  }
  const std::vector<double> criteria = profile.criteria();
  fit.rates = fitted(series, groups, common, where != MlMaximum::finite,
                     [&](std::size_t group, double x) { return normal_cdf(criteria[group] + fit.slope * x); });
  if (!with_interval) return fit;

  const double target = fit.log_likelihood - kProfileDrop;
  double inside = fit.slope;
  if (where != MlMaximum::finite) {
    // The profile rises (falls) all the way: some finite place inside the interval.
    const double direction = where == MlMaximum::at_plus_infinity ? 1 : -1;
    inside = 0;
    double step = profile.scale();
    while (profile.at(inside).value < target && step < kInf) {
      inside = direction * step;
      step *= 2;
    }
  }
  fit.ci_low = where == MlMaximum::at_minus_infinity ? -kInf : profile.crossing(inside, -1, target);
  fit.ci_high = where == MlMaximum::at_plus_infinity ? kInf : profile.crossing(inside, +1, target);
  return fit;
}

MlSlope differencing_slope(std::span<const SeriesCounts> series, std::span<const MlGroup> groups, bool common,
                           bool with_interval) {
  DifferencingProfile profile(groups);
  MlSlope fit;
  fit.ci_low = fit.ci_high = kNaN;
  const bool at_infinity = ml_maximum(groups) == MlMaximum::at_plus_infinity;
  if (at_infinity) {
    fit.slope = kInf;
    fit.log_likelihood = saturated_log_likelihood(groups);
  } else {
    const DifferencingProfile::Point best = profile.maximum();
    fit.slope = best.m;
    fit.log_likelihood = best.value;
  }
  const std::vector<double> criteria = profile.criteria();
  fit.rates = fitted(series, groups, common, at_infinity, [&](std::size_t group, double x) {
    const double d = fit.slope * x, root_two = 1.4142135623730951;
    return normal_cdf((d - criteria[group]) / root_two) + normal_cdf((-d - criteria[group]) / root_two);
  });
  if (!with_interval) return fit;
  const DifferencingProfile::Interval interval = profile.interval(fit.log_likelihood - kProfileDrop, at_infinity);
  fit.ci_low = interval.low;
  fit.ci_high = interval.high;
  return fit;
}

MlSlope fit_slope(std::span<const SeriesCounts> series, JndMethod method, bool with_interval) {
  const bool common = is_common(method);
  const std::vector<MlGroup> groups = ml_groups(series, common);
  if (ml_maximum(groups) == MlMaximum::anywhere) {
    MlSlope fit;
    fit.slope = fit.log_likelihood = fit.ci_low = fit.ci_high = kNaN;
    if (series.empty()) return fit;
    fit.log_likelihood = 0;
    fit.rates = fitted(series, groups, common, true, [](std::size_t, double) { return kNaN; });
    if (with_interval) {
      fit.ci_low = is_differencing(method) ? 0 : -kInf;
      fit.ci_high = kInf;
    }
    return fit;
  }
  return is_differencing(method) ? differencing_slope(series, groups, common, with_interval)
                                 : yes_no_slope(series, groups, common, with_interval);
}

}  // namespace

MlSlope ml_slope(std::span<const SeriesCounts> series, JndMethod method) {
  return fit_slope(series, method, true);
}

MlSlope ml_point(std::span<const SeriesCounts> series, JndMethod method) {
  return fit_slope(series, method, false);
}

}  // namespace jnd
