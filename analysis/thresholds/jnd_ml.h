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

}  // namespace jnd
