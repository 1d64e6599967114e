// d' of the yes-no model by maximum likelihood on the raw counts, with a profile-likelihood interval.
//
// H = Phi(l + d'), F = Phi(l); the log-likelihood, without binomial constants, is concave in (d', l). The estimate is
// z(H) - z(F) of the raw rates; the interval comes from the likelihood maximised over l at each d' and stays honest
// where a rate is 0 or 1, where a Wald interval is undefined.
//
// Source: DeCarlo 1998, Psychol Methods 3:186 (the model as probit regression); profile_interval.h for the interval.
#pragma once

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

}  // namespace jnd
