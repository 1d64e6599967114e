// d' of the independent-observation model of same-different: the observer takes the likelihood ratio of "different" to
// "same" from both intervals. Two presentations of it, both on corrected rates.
//
// Source: Macmillan and Creelman 2005, Detection Theory, 2nd ed., chapter 9 (unit slope); Dai, Versfeld and Green 1996,
// Percept Psychophys 58:1, and Noreen 1981 (likelihood-ratio observer).
#pragma once

#include "analysis/detection/counts.h"

namespace jnd {

// As if the ROC were that of the yes-no model: proportion correct of the unbiased observer pmax = Phi((zH - zF)/2), and
// d' = 2 z((1 + sqrt(2 pmax - 1))/2). Below pmax = 1/2 the sign is reflected. +-inf in, +-inf out; NaN in, NaN out.
double unit_slope_dprime(double yes_no_dprime) noexcept;

struct LikelihoodRatioObserver {
  double dprime;        // NaN where H <= F, or a rate is 0 or 1
  double ln_criterion;  // answers "different" where the log likelihood ratio exceeds it
};
// d' and criterion that give these rates; the complements are given apart, so that no digit is lost near 1. H > F.
// d' agrees with 25-digit quadrature to 1e-9 for d' between 0.5 and 6.
LikelihoodRatioObserver likelihood_ratio_observer(double hit, double miss, double false_alarm,
                                                  double correct_rejection);

struct IndependentObservation {
  double unit_slope;  // NaN only where a class is missing, or under Correction::none without information
  double exact;       // of the likelihood-ratio observer; NaN at H <= F
  double ln_criterion;
};
IndependentObservation independent_observation(const Counts& counts, Correction correction);

}  // namespace jnd
