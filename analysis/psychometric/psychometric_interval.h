// Confidence intervals of a psychometric function, and how well it fits: from the profile of the likelihood, or from a
// parametric bootstrap.
//
// Source: Venzon and Moolgavkar 1988, Applied Statistics 37:87-94 (profiles); Wichmann and Hill 2001, "The psychometric
// function II", Perception & Psychophysics 63:1314-1329 (bootstrap); Davison and Hinkley 1997, Bootstrap Methods, 4.2.3
// (Monte Carlo p).
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "analysis/numerics/special_values.h"
#include "analysis/psychometric/psychometric.h"

namespace jnd {

// NaN where undefined, infinite or 0 where nothing bounds the quantity on that side.
struct ConfidenceBounds {
  double low = kNaN;
  double high = kNaN;
};

struct PsychometricIntervals {
  double confidence = 0.95;
  ConfidenceBounds location, second;  // the two named parameters
  ConfidenceBounds lapse, guess;      // NaN where fixed
  ConfidenceBounds pse, jnd, slope;
};

// For each quantity the values at which the largest likelihood (times prior under map) over everything else lies within
// chi-square(1) / 2 of the largest of all: from the estimate outwards to the first crossing. confidence in (0, 1).
// A free rate's interval ends at its bound where nothing is crossed before. Under separated the JND's lower bound is 0
// and the slope's upper one infinite; under not_increasing only second, JND and slope have an interval (weibull: only
// its shape); under no_information and not_identified all are NaN. Throws as fit_psychometric.
PsychometricIntervals psychometric_profile(std::span<const PsychometricLevel> levels, const PsychometricModel& model,
                                           double confidence = 0.95);

struct PsychometricBootstrap {
  PsychometricIntervals intervals;
  int replicates = 0;
  // Replicates by what their fit said. Separated ones count as JND 0 and slope infinite, not increasing ones as JND
  // infinite and slope 0: leaving them out would make intervals too short. The others (one answer throughout, not
  // identified) and an undefined PSE are left out.
  int estimates = 0, separated = 0, not_increasing = 0, others = 0;
  int with_pse = 0;
  // (1 + replicates with a deviance at least as large) / (1 + replicates); NaN without a fit.
  double deviance_p = kNaN;
};

// Counts drawn from the fitted function, fitted again by the same model; percentile intervals. The same seed gives the
// same numbers everywhere (std::mt19937_64, binomial by inversion), alone or among other fits. replicates >= 1. All NaN
// where the fit of the data is no estimate. progress hears how many replicates are done, after each.
PsychometricBootstrap psychometric_bootstrap(std::span<const PsychometricLevel> levels, const PsychometricModel& model,
                                             int replicates, std::uint64_t seed, double confidence = 0.95,
                                             const std::function<void(int)>& progress = {});

}  // namespace jnd
