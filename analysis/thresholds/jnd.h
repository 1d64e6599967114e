// The just-noticeable difference: the stiffness difference at d' = 1, from d' at several differences.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "analysis/detection/counts.h"
#include "analysis/numerics/special_values.h"

namespace jnd {

enum class JndStatus {
  ok,
  no_sensitivity,  // slope <= 1e-9: no difference is noticeable
  ceiling,         // slope infinite: the JND is below anything that was tested
  no_information   // every series was missing, or the answers say nothing about the slope (all the same)
};
std::string_view to_string(JndStatus status) noexcept;

// Remarks that exclude nothing.
enum class Caution {
  extrapolated,   // JND outside the tested differences
  floor,          // every d' at the largest value that the correction allows: the JND cannot come out lower
  few_trials,     // fewer than 10 trials a class in some series
  series_missing  // a series with an empty class was left out
};
std::string_view to_string(Caution caution) noexcept;

// One series of one participant and condition.
struct SeriesCounts {
  double difference = 0;  // N/m, > 0
  Counts counts;
};

// How the slope is estimated. The models differ by a factor of 1.5 to 2.8: every printed number names its method.
enum class JndMethod {
  least_squares,       // m = sum(dK d') / sum(dK^2) (Chinello 2017, section 5.1.3); the paper-compatible default
  weighted,            // m = sum(w dK d') / sum(w dK^2), w = 1/se^2 of the log-linear d' (Gourevitch and Galanter 1967)
  inverse_mean_slope,  // m = mean(d' / dK)
  mean_of_ratios,      // JND = mean(dK / d'), slope = 1/JND; refused (no_sensitivity) where any d' / dK <= 1e-9
  ml_yes_no_common,    // joint binomial likelihood, P("different") = Phi(l + m x); one criterion l for all series
  ml_yes_no_series,    // the same, a criterion for each series
  ml_differencing_common,    // joint likelihood of the differencing model with d' = m dK; one criterion tau
  ml_differencing_series,    // the same, a criterion for each series
  least_squares_independent  // least_squares of the d' of the independent-observation model, unit slope
};
// All of them, in the order in which they are printed.
inline constexpr std::array kJndMethods = {JndMethod::least_squares,
                                           JndMethod::weighted,
                                           JndMethod::inverse_mean_slope,
                                           JndMethod::mean_of_ratios,
                                           JndMethod::ml_yes_no_common,
                                           JndMethod::ml_yes_no_series,
                                           JndMethod::ml_differencing_common,
                                           JndMethod::ml_differencing_series,
                                           JndMethod::least_squares_independent};
std::string_view to_string(JndMethod method) noexcept;
std::optional<JndMethod> jnd_method_from(std::string_view name) noexcept;
bool is_maximum_likelihood(JndMethod method) noexcept;

struct JndEstimate {
  JndStatus status = JndStatus::no_information;
  std::vector<Caution> cautions;
  int series_used = 0;
  double slope = 0;  // d' per N/m; NaN under no_information and where mean_of_ratios is refused
  double jnd = 0;    // N/m, 1 / slope; NaN under no_sensitivity and no_information, 0 at the ceiling
  double weber = 0;  // jnd / reference; NaN where jnd is

  JndMethod method = JndMethod::least_squares;
  // 95 % profile-likelihood bounds (drop of 1.920729) of the maximum-likelihood methods; NaN for the others. Where
  // every answer was the same they say that anything is possible: -inf..inf (differencing: 0..inf), JND 0..inf.
  double slope_ci_low = kNaN;   // -inf..; differencing: 0 where not crossed
  double slope_ci_high = kNaN;  // inf at the ceiling
  double ci_low = kNaN;         // of the JND: 1 / slope_ci_high; inf where that is <= 1e-9
  double ci_high = kNaN;        // of the JND: 1 / slope_ci_low; inf where that is <= 1e-9
  // At the estimate (at the ceiling: its limit), natural logarithm, without binomial constants; NaN for closed forms
  // and where no series could be used.
  double log_likelihood = kNaN;
};

// All functions of this file: series in any order, difference > 0, counts with 0 <= hits <= n_diff and
// 0 <= false_alarms <= n_same; reference > 0. A series with an empty class is left out and named by a caution.

// correction: what the closed forms do about rates of 0 and 1; maximum likelihood works on the raw counts and ignores
// it. `weighted` takes its weights from the log-linear rates under every correction. same: shared where the same trials of
// every series are those of all; likelihoods count them once, which needs a criterion that is common.
enum class SameTrials { own, shared };
JndEstimate estimate_jnd(std::span<const SeriesCounts> series, double reference_n_per_m, JndMethod method,
                         Correction correction, SameTrials same = SameTrials::own);

// estimate_jnd with JndMethod::least_squares. Series without information stay in with their corrected d' (0), the
// paper's convention.
JndEstimate least_squares_jnd(std::span<const SeriesCounts> series, double reference_n_per_m, Correction correction);

// d' per N/m: at or below this a slope is a rounding zero. At 1e-9 the JND would be 1e9 N/m.
inline constexpr double kLeastSlope = 1e-9;

// What every estimate of a threshold asks of its series, whichever the method.
struct UsableSeries {
  std::vector<SeriesCounts> series;  // both classes have trials
  bool missing = false;              // some series was left out
  bool few_trials = false;           // fewer than 10 trials in a class of some series that is used
  bool any_information = false;      // some series has both answers
  bool all_at_largest = false;       // in every series: every different pair found, no equal pair mistaken
  double smallest = 0, largest = 0;  // tested differences, N/m; 0 without series
};
UsableSeries usable_series(std::span<const SeriesCounts> series);

// Slopes in closed form, from the d' of each series (yes-no model).
struct ClosedSlope {
  double slope = 0;      // d' per N/m; inf at the ceiling; NaN where undefined or refused
  bool refused = false;  // mean_of_ratios with some d' / dK <= 1e-9: a mean over a pole
};

// method: one of those that are not maximum likelihood; the others give NaN. Without any series that has both answers
// the slope is NaN: the corrected rates of constant answers are a convention, not an observation.
ClosedSlope closed_slope(const UsableSeries& usable, JndMethod method, Correction correction);

// Gourevitch and Galanter 1967 (Psychometrika 32:25): the variance of the d' of log-linear rates, raw n in the
// denominators. Both classes have trials.
double loglinear_variance(const Counts& counts);

}  // namespace jnd
