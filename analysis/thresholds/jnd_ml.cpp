#include "analysis/thresholds/jnd_ml.h"

#include <algorithm>
#include <cmath>

#include "analysis/numerics/normal.h"
#include "analysis/numerics/profile_interval.h"
#include "analysis/numerics/special_values.h"
#include "analysis/thresholds/jnd_ml_differencing.h"
#include "analysis/thresholds/jnd_ml_yes_no.h"

namespace jnd {

namespace {

// k log(k/n) + (n - k) log(1 - k/n), with 0 log 0 = 0.
double saturated_cell(const MlCell& cell) noexcept {
  double sum = 0;
  if (cell.said > 0) sum += cell.said * std::log(cell.said / cell.n);
  if (cell.unsaid() > 0) sum += cell.unsaid() * std::log(cell.unsaid() / cell.n);
  return sum;
}

void add_cell(std::vector<MlCell>& cells, double x, int n, int said) {
  const auto at =
      std::lower_bound(cells.begin(), cells.end(), x, [](const MlCell& cell, double x) { return cell.x < x; });
  if (at != cells.end() && at->x == x) {
    at->n += n;
    at->said += said;
    return;
  }
  MlCell cell;
  cell.x = x;
  cell.n = n;
  cell.said = said;
  cells.insert(at, cell);
}

void classify(MlGroup& group) {
  double least_said = kInf, most_said = -kInf, least_unsaid = kInf, most_unsaid = -kInf;
  for (const MlCell& cell : group.cells) {
    if (cell.said > 0) {
      least_said = std::min(least_said, cell.x);
      most_said = std::max(most_said, cell.x);
    }
    if (cell.unsaid() > 0) {
      least_unsaid = std::min(least_unsaid, cell.x);
      most_unsaid = std::max(most_unsaid, cell.x);
    }
    group.saturated += saturated_cell(cell);
  }
  group.all_alike = most_said == -kInf || most_unsaid == -kInf;
  // One difference may have both answers: the criterion then sits there, and every other cell is certain in the limit.
  group.rises = !group.all_alike && most_unsaid <= least_said;
  group.falls = !group.all_alike && most_said <= least_unsaid;
}

}  // namespace

std::vector<MlGroup> ml_groups(std::span<const SeriesCounts> series, bool common) {
  std::vector<MlGroup> groups;
  for (const SeriesCounts& one : series) {
    if (groups.empty() || !common) groups.emplace_back();
    add_cell(groups.back().cells, 0, one.counts.n_same, one.counts.false_alarms);
    add_cell(groups.back().cells, one.difference, one.counts.n_diff, one.counts.hits);
  }
  for (MlGroup& group : groups) classify(group);
  return groups;
}

MlMaximum ml_maximum(std::span<const MlGroup> groups) noexcept {
  bool any = false, all_rise = true, all_fall = true;
  for (const MlGroup& group : groups) {
    if (group.all_alike) continue;
    any = true;
    all_rise = all_rise && group.rises;
    all_fall = all_fall && group.falls;
  }
  if (!any) return MlMaximum::anywhere;
  if (all_rise) return MlMaximum::at_plus_infinity;
  return all_fall ? MlMaximum::at_minus_infinity : MlMaximum::finite;
}

double saturated_log_likelihood(std::span<const MlGroup> groups) noexcept {
  double sum = 0;
  for (const MlGroup& group : groups) sum += group.saturated;
  return sum;
}

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
