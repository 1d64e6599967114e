// What d' could have come out if the corrected rates were true: the parametric bootstrap, not by drawing but by all
// outcomes with their probabilities.
#pragma once

#include "analysis/detection/counts.h"

namespace jnd {

// Of the log-linear d' of new counts (h*, f*), h* ~ Binomial(n_diff, H) and f* ~ Binomial(n_same, F), with H and F the
// log-linear rates of the observed counts. NaN where a class is missing.
struct DprimeBootstrap {
  double mean, sd;        // sd of the distribution itself
  double q025, q975;      // the smallest d* that occurs with P(d' <= d*) >= 0.025, 0.975
  double p_q025, p_q975;  // those probabilities: above the nominal ones, as the distribution is discrete
};
// Exact up to rounding; outcomes of less than 1e-30 of the likeliest are left out. Values closer than 1e-11 count as
// one. Time and memory grow as the square root of the trials.
DprimeBootstrap dprime_bootstrap(const Counts& counts);

}  // namespace jnd
