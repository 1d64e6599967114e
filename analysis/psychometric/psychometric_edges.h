// The two edges of a psychometric family, where no function of it lies but its likelihood may be largest: slope 0 (one
// rate at every level) and slope infinite (a step). Both suprema have closed forms.
#pragma once

#include "analysis/psychometric/psychometric_likelihood.h"

namespace jnd {

struct PsychometricEdge {
  double value = 0;           // the supremum, with the prior of map
  double log_likelihood = 0;  // the same without the prior
  double lapse = 0, guess = 0;
  double level = 0;  // of a step: the x of the one level that lies on it; NaN where it lies between two levels
  // A function of the family so near to the edge that nothing is left to gain, for searches that start there.
  double c0 = 0, c1 = 0;
  double t = 0;  // of a step: its place on the t axis
};

PsychometricEdge flat_edge(const PsychometricLikelihood& likelihood) noexcept;

// At least two levels. Value -inf, and nothing else of use, where known rates make every step impossible.
PsychometricEdge step_edge(const PsychometricLikelihood& likelihood) noexcept;

}  // namespace jnd
