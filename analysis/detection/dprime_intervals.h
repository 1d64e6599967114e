// How far d' may lie from its estimate. d' of the yes-no model by maximum likelihood on the raw counts, with a profile-likelihood interval.
//
// H = Phi(l + d'), F = Phi(l); the log-likelihood, without binomial constants, is concave in (d', l). The estimate is
// z(H) - z(F) of the raw rates; the interval comes from the likelihood maximised over l at each d' and stays honest
// where a rate is 0 or 1, where a Wald interval is undefined.
//
// Source: DeCarlo 1998, Psychol Methods 3:186 (the model as probit regression); profile_interval.h for the interval.
#pragma once

#include "analysis/detection/counts.h"
#include "analysis/detection/yes_no.h"

namespace jnd {

struct DprimeProfile {
  RateStatus status = RateStatus::missing;
  double dprime;           // +-inf where one rate is 0 or 1; NaN under no_information and missing
  double ci_low, ci_high;  // 95 %; one may be infinite; -inf..inf under no_information, NaN under missing
  double log_likelihood;   // at the estimate; 0 under no_information (every answer is then certain), NaN under missing
  double p_value;          // two-sided likelihood-ratio test of d' = 0, chi-square(1); 1 under no_information
};

DprimeProfile yes_no_profile(const Counts& counts) noexcept;

// The estimate and the p value alone, where no interval is wanted.
double yes_no_p_value(const Counts& counts) noexcept;

// What d' could have come out if the corrected rates were true: the parametric bootstrap, not by drawing but by all
// outcomes with their probabilities.

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
