#include "analysis/thresholds/jnd_closed.h"

#include <cmath>

#include "analysis/detection/independent_observation.h"
#include "analysis/detection/yes_no.h"
#include "analysis/numerics/normal.h"
#include "analysis/numerics/special_values.h"

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

}  // namespace jnd
