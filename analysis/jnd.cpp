#include "analysis/jnd.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/yes_no.h"

namespace jnd {

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
// d' per N/m: below this a slope is a rounding zero. At 1e-9 the JND would be 1e9 N/m.
constexpr double kLeastSlope = 1e-9;
constexpr int kFewTrials = 10;

// Every different pair found and no equal pair mistaken: with a correction, d' cannot be larger with these n.
bool at_largest_dprime(const Counts& counts) noexcept {
  return counts.hits == counts.n_diff && counts.false_alarms == 0;
}

JndStatus status_of(double slope) noexcept {
  if (std::isnan(slope)) return JndStatus::no_information;
  if (slope == std::numeric_limits<double>::infinity()) return JndStatus::ceiling;
  return slope <= kLeastSlope ? JndStatus::no_sensitivity : JndStatus::ok;
}

}  // namespace

std::string_view to_string(JndStatus status) noexcept {
  switch (status) {
    case JndStatus::ok:
      return "ok";
    case JndStatus::no_sensitivity:
      return "no_sensitivity";
    case JndStatus::ceiling:
      return "ceiling";
    case JndStatus::no_information:
      return "no_information";
  }
  return "";
}

std::string_view to_string(Caution caution) noexcept {
  switch (caution) {
    case Caution::extrapolated:
      return "extrapolated";
    case Caution::floor:
      return "floor";
    case Caution::few_trials:
      return "few_trials";
    case Caution::series_missing:
      return "series_missing";
  }
  return "";
}

JndEstimate least_squares_jnd(std::span<const SeriesCounts> series, double reference_n_per_m, Correction correction) {
  JndEstimate result;
  double sum_products = 0, sum_squares = 0;
  double smallest = std::numeric_limits<double>::infinity(), largest = 0;
  bool missing = false, few = false, any_information = false, all_at_largest = true;
  for (const SeriesCounts& one : series) {
    const YesNo rates = yes_no(one.counts, correction);
    if (rates.status == RateStatus::missing) {
      missing = true;
      continue;
    }
    ++result.series_used;
    any_information = any_information || rates.status == RateStatus::ok;
    few = few || std::min(one.counts.n_diff, one.counts.n_same) < kFewTrials;
    all_at_largest = all_at_largest && at_largest_dprime(one.counts);
    smallest = std::min(smallest, one.difference);
    largest = std::max(largest, one.difference);
    // Under Correction::none a series without information has d' = inf - inf = NaN, and opposite infinities cancel to
    // NaN: the slope is then undefined, not a number of the remaining series.
    sum_products += one.difference * rates.dprime;
    sum_squares += one.difference * one.difference;
  }

  result.slope = any_information ? sum_products / sum_squares : kNaN;
  result.status = status_of(result.slope);
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

  if (result.status == JndStatus::ok && (result.jnd < smallest || result.jnd > largest))
    result.cautions.push_back(Caution::extrapolated);
  if (result.status == JndStatus::ok && all_at_largest) result.cautions.push_back(Caution::floor);
  if (few) result.cautions.push_back(Caution::few_trials);
  if (missing) result.cautions.push_back(Caution::series_missing);
  return result;
}

}  // namespace jnd
