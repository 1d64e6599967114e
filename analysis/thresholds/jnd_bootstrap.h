// How far a least-squares JND could have come out differently: a parametric bootstrap of its counts.
//
// Each replicate draws the hits and false alarms of every usable series anew, binomially, with the trials of the
// original and the log-linear rates of the original as probabilities, and goes through the same estimate (Efron and
// Tibshirani 1993, An Introduction to the Bootstrap, section 6.5). Log-linear whatever the correction of the estimate
// is: raw rates of 0 and 1 would never vary. No model of the slope is assumed in the draw, only in the estimate.
#pragma once

#include <cstdint>
#include <span>

#include "analysis/thresholds/jnd.h"

namespace jnd {

struct JndBootstrap {
  // 95 % percentile interval of the JND over the replicates with a slope; no_sensitivity counts as +inf and ceiling as
  // 0, so that nothing is dropped for looking bad. NaN where no replicate has a slope.
  double ci_low = 0, ci_high = 0;
  double slope_ci_low = 0, slope_ci_high = 0;
  int replicates = 0;                                               // drawn
  int ok = 0, no_sensitivity = 0, ceiling = 0, no_information = 0;  // they add up to replicates
};

// replicates >= 1 (2000 give the bounds to about 5 % of the interval's width); the same seed gives the same counts on
// every machine. Replicate i does not depend on how many are drawn. As in estimate_jnd for the rest.
JndBootstrap least_squares_bootstrap(std::span<const SeriesCounts> series, Correction correction, int replicates,
                                     std::uint64_t seed);

}  // namespace jnd
