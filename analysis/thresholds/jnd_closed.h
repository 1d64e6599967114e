// Slopes in closed form, from the d' of each series (yes-no model).
#pragma once

#include "analysis/detection/counts.h"
#include "analysis/thresholds/jnd.h"
#include "analysis/thresholds/jnd_series.h"

namespace jnd {

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
