// d' of the differencing model of same-different: maximum likelihood on raw counts, and the model solved for corrected
// rates. The formulas of H and F are in differencing_model.h.
//
// The likelihood is largest where the model meets both observed rates; where it cannot, at a boundary:
//   no false alarms                        d' = tau = inf
//   only hits, some false alarms           d' = inf, tau from F
//   H <= F                                 d' = 0, tau from the rate of "different" pooled over both classes
//   all answers "same" or all "different"  undefined
//
// Source: Macmillan and Creelman 2005, chapter 9; Christensen, Lee and Brockhoff 2012, J Sens Stud 27:1 (`samediff` of
// sensR). That program stops a little short of the boundary estimate of tau (3.7e-5 at tau = 0.954).
#pragma once

#include <string_view>

#include "analysis/detection/counts.h"

namespace jnd {

enum class DifferencingStatus {
  ok,
  no_sensitivity,  // of corrected rates only: H <= F, which no d' of the model gives; d' is set to 0
  no_information,  // one and the same answer throughout
  missing          // no trial of one class
};
std::string_view to_string(DifferencingStatus status) noexcept;

struct DifferencingFit {
  DifferencingStatus status = DifferencingStatus::missing;
  double dprime, tau;        // >= 0, may be inf
  double se_dprime, se_tau;  // delta method; NaN where the estimate is infinite, and of d' at 0
  double log_likelihood;     // of the raw counts at the estimate, without binomial constants
};

// Maximum likelihood on raw counts; every number is NaN under no_information and missing. The status is never
// no_sensitivity: d' = 0 is the estimate then.
DifferencingFit differencing_fit(const Counts& counts) noexcept;

// The model solved for the corrected rates. At H <= F: d' = 0, with tau from the corrected F alone. Under
// no_information the arithmetic of the corrected rates stands, except with Correction::none. log_likelihood is of the
// raw counts; standard errors use the corrected rates and the raw numbers of trials.
DifferencingFit differencing_of_rates(const Counts& counts, Correction correction) noexcept;

// The fit with what costs more: 95 % profile-likelihood intervals and the test. NaN where the fit is undefined.
struct Differencing {
  DifferencingFit fit;
  double ci_low, ci_high;    // of d'; low 0 where the profile does not fall far enough above 0; high inf with d'
  double tau_low, tau_high;  // of tau
  double p_value;            // one-sided, of d' = 0: 1 - Phi(signed root of the deviance); 0.5 at the boundary d' = 0
};
Differencing differencing(const Counts& counts) noexcept;

// That p value alone; NaN under no_information and missing.
double differencing_p_value(const Counts& counts) noexcept;

}  // namespace jnd
