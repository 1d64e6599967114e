// The slope by maximum likelihood over all series together, with its profile-likelihood interval.
//
// Both models say how likely the answer "different" is at a difference x (0 for equal stimuli):
//   yes-no        Phi(l + m x)                                                        l: criterion, any real number
//   differencing  1 - Phi((tau - m x)/sqrt 2) + Phi((-tau - m x)/sqrt 2), m >= 0      tau: criterion, >= 0
// with one criterion for all series or one for each (Macmillan and Creelman 2005, Detection Theory, chapters 1 and 9).
#pragma once

#include <span>
#include <vector>

#include "analysis/thresholds/jnd.h"

namespace jnd {

struct MlSlope {
  double slope = 0;           // d' per N/m; +-inf where the likelihood grows for ever; NaN where every answer was alike
  double log_likelihood = 0;  // without binomial constants; a limit where the slope is infinite
  double ci_low = 0, ci_high = 0;  // NaN where there is no series
  // For each series, the probabilities of "different" that the fit gives (limits where the slope is infinite).
  struct Rates {
    double different_pair = 0;  // of a hit
    double equal_pair = 0;      // of a false alarm
  };
  std::vector<Rates> rates;
};

// series: each with trials of both classes; see usable_series. method: a maximum-likelihood one (others: as
// ml_yes_no_series). Exact whatever the counts: rates of 0 and 1 are no special case unless the maximum itself lies at
// infinity, which is decided from the counts and not from a diverging iteration.
MlSlope ml_slope(std::span<const SeriesCounts> series, JndMethod method);

// The same without the interval (ci_* NaN), for resampling.
MlSlope ml_point(std::span<const SeriesCounts> series, JndMethod method);

// The cells of a joint likelihood: how often "different" was said at each difference, in groups that share a criterion.
struct MlCell {
  double x = 0;     // difference, N/m; 0: equal stimuli
  double n = 0;     // trials, > 0
  double said = 0;  // of them answered "different"
  double unsaid() const noexcept { return n - said; }
};

struct MlGroup {
  std::vector<MlCell> cells;  // x ascending, each once

  bool all_alike = false;  // one and the same answer throughout: fits every slope perfectly (criterion at infinity)
  // Every "different" was said at differences as large as every "same", or larger: the likelihood grows with m for
  // ever. falls: the other way round. Never both, and neither where all_alike.
  bool rises = false, falls = false;

  // sum of k log(k/n) + (n-k) log(1 - k/n): what no model exceeds, and what a separated group attains at infinity.
  double saturated = 0;
};

// common: one group of all cells; otherwise a group a series, in the order of the series.
std::vector<MlGroup> ml_groups(std::span<const SeriesCounts> series, bool common);

enum class MlMaximum { finite, at_plus_infinity, at_minus_infinity, anywhere };
// Where the likelihood of a model with d' = m x has its maximum. For the yes-no model; with m >= 0, falling groups have
// their maximum at m = 0, which is finite.
MlMaximum ml_maximum(std::span<const MlGroup> groups) noexcept;

// Sum of `saturated` over the groups: the limit of the log-likelihood at infinity where all of them are separated
// alike.
double saturated_log_likelihood(std::span<const MlGroup> groups) noexcept;

}  // namespace jnd
