// A fit together with the likelihood it maximises, for what goes on from there: intervals and comparisons.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "analysis/psychometric/psychometric_likelihood.h"

namespace jnd {

struct PsychometricSolution {
  PsychometricFit fit;
  PsychometricLikelihood likelihood;
  std::vector<double> place;  // c0, c1, lapse, guess; empty under no_information and not_identified
  double value = 0;           // the largest log-likelihood, with the prior of map; a supremum like fit.log_likelihood
};

// As fit_psychometric. Under separated the place is a very steep function near the supremum, under not_increasing a
// very flat one.
PsychometricSolution solve_psychometric(std::span<const PsychometricLevel> levels, const PsychometricModel& model);

}  // namespace jnd
