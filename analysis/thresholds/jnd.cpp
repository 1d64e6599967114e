#include "analysis/thresholds/jnd.h"

#include <algorithm>
#include <cmath>

#include "analysis/detection/independent_observation.h"
#include "analysis/detection/yes_no.h"
#include "analysis/numerics/normal.h"
#include "analysis/numerics/special_values.h"
#include "analysis/numerics/words.h"
#include "analysis/thresholds/jnd_ml.h"

namespace jnd {

namespace {

double variance_of_z(int k, int n) {
  const double rate = corrected_rate(k, n, Correction::loglinear);
  const double density = normal_density(normal_quantile(rate));
  return rate * (1 - rate) / (n * density * density);
}

// sum(w dK d') / sum(w dK^2). An undefined d' (inf - inf under Correction::none) and opposite infinities leave NaN: the
// slope is then undefined, not a number of the remaining series.
double regression(const UsableSeries& usable, Correction correction, bool weighted) {
  double sum_products = 0, sum_squares = 0;
  for (const SeriesCounts& one : usable.series) {
    const double weight = weighted ? 1 / loglinear_variance(one.counts) : 1;
    sum_products += weight * one.difference * yes_no(one.counts, correction).dprime;
    sum_squares += weight * one.difference * one.difference;
  }
  return sum_products / sum_squares;
}

double independent_regression(const UsableSeries& usable, Correction correction) {
  double sum_products = 0, sum_squares = 0;
  for (const SeriesCounts& one : usable.series) {
    sum_products += one.difference * unit_slope_dprime(yes_no(one.counts, correction).dprime);
    sum_squares += one.difference * one.difference;
  }
  return sum_products / sum_squares;
}

double mean_slope(const UsableSeries& usable, Correction correction) {
  double sum = 0;
  for (const SeriesCounts& one : usable.series) sum += yes_no(one.counts, correction).dprime / one.difference;
  return sum / static_cast<double>(usable.series.size());
}

ClosedSlope mean_of_ratios(const UsableSeries& usable, Correction correction) {
  double sum = 0;
  bool refused = false;
  for (const SeriesCounts& one : usable.series) {
    const double dprime = yes_no(one.counts, correction).dprime;
    if (std::isnan(dprime)) return {kNaN, false};
    refused = refused || dprime / one.difference <= kLeastSlope;
    sum += one.difference / dprime;
  }
  if (refused) return {kNaN, true};
  return {static_cast<double>(usable.series.size()) / sum, false};
}

}  // namespace

double loglinear_variance(const Counts& counts) {
  return variance_of_z(counts.hits, counts.n_diff) + variance_of_z(counts.false_alarms, counts.n_same);
}

ClosedSlope closed_slope(const UsableSeries& usable, JndMethod method, Correction correction) {
  if (!usable.any_information) return {kNaN, false};
  if (method == JndMethod::least_squares) return {regression(usable, correction, false), false};
  if (method == JndMethod::weighted) return {regression(usable, correction, true), false};
  if (method == JndMethod::inverse_mean_slope) return {mean_slope(usable, correction), false};
  if (method == JndMethod::mean_of_ratios) return mean_of_ratios(usable, correction);
  if (method == JndMethod::least_squares_independent) return {independent_regression(usable, correction), false};
  return {kNaN, false};
}

namespace {

constexpr int kFewTrials = 10;

// Bounds of 1/m from bounds of m; a JND is positive, so that slopes at or below zero count as infinite JNDs.
double jnd_bound(double slope) noexcept {
  if (std::isnan(slope)) return kNaN;
  return slope > kLeastSlope ? 1.0 / slope : kInf;
}

JndStatus status_of(double slope) noexcept {
  if (std::isnan(slope)) return JndStatus::no_information;
  if (slope == kInf) return JndStatus::ceiling;
  return slope <= kLeastSlope ? JndStatus::no_sensitivity : JndStatus::ok;
}

void add_cautions(JndEstimate& result, const UsableSeries& usable) {
  const bool ok = result.status == JndStatus::ok;
  if (ok && (result.jnd < usable.smallest || result.jnd > usable.largest))
    result.cautions.push_back(Caution::extrapolated);
  if (ok && usable.all_at_largest) result.cautions.push_back(Caution::floor);
  if (usable.few_trials) result.cautions.push_back(Caution::few_trials);
  if (usable.missing) result.cautions.push_back(Caution::series_missing);
}

constexpr auto kJndStatusWords = words<JndStatus>({{"ok", JndStatus::ok},
                                                   {"no_sensitivity", JndStatus::no_sensitivity},
                                                   {"ceiling", JndStatus::ceiling},
                                                   {"no_information", JndStatus::no_information}});
constexpr auto kCautionWords = words<Caution>({{"extrapolated", Caution::extrapolated},
                                               {"floor", Caution::floor},
                                               {"few_trials", Caution::few_trials},
                                               {"series_missing", Caution::series_missing}});
constexpr auto kJndMethodWords =
    words<JndMethod>({{"least_squares", JndMethod::least_squares},
                      {"weighted", JndMethod::weighted},
                      {"inverse_mean_slope", JndMethod::inverse_mean_slope},
                      {"mean_of_ratios", JndMethod::mean_of_ratios},
                      {"ml_yes_no_common", JndMethod::ml_yes_no_common},
                      {"ml_yes_no_series", JndMethod::ml_yes_no_series},
                      {"ml_differencing_common", JndMethod::ml_differencing_common},
                      {"ml_differencing_series", JndMethod::ml_differencing_series},
                      {"least_squares_independent", JndMethod::least_squares_independent}});

}  // namespace

std::string_view to_string(JndStatus status) noexcept {
  return word_of(kJndStatusWords, status);
}

std::string_view to_string(Caution caution) noexcept {
  return word_of(kCautionWords, caution);
}

std::string_view to_string(JndMethod method) noexcept {
  return word_of(kJndMethodWords, method);
}

std::optional<JndMethod> jnd_method_from(std::string_view name) noexcept {
  return value_of(kJndMethodWords, name);
}

bool is_maximum_likelihood(JndMethod method) noexcept {
  switch (method) {
    case JndMethod::ml_yes_no_common:
    case JndMethod::ml_yes_no_series:
    case JndMethod::ml_differencing_common:
    case JndMethod::ml_differencing_series:
      return true;
    case JndMethod::least_squares:
    case JndMethod::weighted:
    case JndMethod::inverse_mean_slope:
    case JndMethod::mean_of_ratios:
    case JndMethod::least_squares_independent:
      return false;
  }
  return false;
}

UsableSeries usable_series(std::span<const SeriesCounts> series) {
  UsableSeries usable;
  for (const SeriesCounts& one : series) {
    const Counts& counts = one.counts;
    if (counts.n_diff == 0 || counts.n_same == 0) {
      usable.missing = true;
      continue;
    }
    const bool first = usable.series.empty();
    const bool at_largest = counts.hits == counts.n_diff && counts.false_alarms == 0;
    const int answers = counts.hits + counts.false_alarms;
    usable.series.push_back(one);
    usable.few_trials = usable.few_trials || std::min(counts.n_diff, counts.n_same) < kFewTrials;
    usable.any_information = usable.any_information ||
                             !(answers == 0 || (counts.hits == counts.n_diff && counts.false_alarms == counts.n_same));
    usable.all_at_largest = (first || usable.all_at_largest) && at_largest;
    usable.smallest = first ? one.difference : std::min(usable.smallest, one.difference);
    usable.largest = first ? one.difference : std::max(usable.largest, one.difference);
  }
  return usable;
}

JndEstimate estimate_jnd(std::span<const SeriesCounts> series, double reference_n_per_m, JndMethod method,
                         Correction correction, SameTrials same) {
  const UsableSeries usable = usable_series(series);
  JndEstimate result;
  result.method = method;
  result.series_used = static_cast<int>(usable.series.size());
  if (is_maximum_likelihood(method)) {
    std::vector<SeriesCounts> counted = usable.series;
    if (same == SameTrials::shared)
      for (std::size_t i = 1; i < counted.size(); ++i) counted[i].counts.n_same = counted[i].counts.false_alarms = 0;
    const MlSlope fit = ml_slope(counted, method);
    result.slope = fit.slope;
    result.slope_ci_low = fit.ci_low;
    result.slope_ci_high = fit.ci_high;
    result.log_likelihood = fit.log_likelihood;
    result.status = status_of(result.slope);
    result.ci_low = jnd_bound(result.slope_ci_high);
    result.ci_high = jnd_bound(result.slope_ci_low);
  } else {
    const ClosedSlope closed = closed_slope(usable, method, correction);
    result.slope = closed.slope;
    result.status = closed.refused ? JndStatus::no_sensitivity : status_of(result.slope);
  }
  switch (result.status) {
    case JndStatus::ok:
      result.jnd = 1.0 / result.slope;
      break;
    case JndStatus::ceiling:
      result.jnd = 0;
      break;
    case JndStatus::no_sensitivity:
    case JndStatus::no_information:
      result.jnd = kNaN;
      break;
  }
  result.weber = result.jnd / reference_n_per_m;
  add_cautions(result, usable);
  return result;
}

JndEstimate least_squares_jnd(std::span<const SeriesCounts> series, double reference_n_per_m, Correction correction) {
  return estimate_jnd(series, reference_n_per_m, JndMethod::least_squares, correction);
}

}  // namespace jnd
