// Reference numbers of signal detection that the program carries: counts, and what independent programs make of them.
#pragma once

#include <span>

#include "analysis/detection/counts.h"

namespace jnd {

struct DetectionCase {
  Counts counts;
  struct YesNo {
    double dprime, criterion, ln_beta, se, ci_low, ci_high;
  } none, loglinear, half;
  struct Profile {
    double dprime, ci_low, ci_high, log_likelihood;
  } profile;
  // tau and se_tau are NaN where d' is 0 or infinite: sensR is not exact there.
  struct Differencing {
    double dprime, tau, se_dprime, se_tau, log_likelihood, ci_low, ci_high, p_value;
  } differencing;
  struct Rates {
    double dprime, tau;
  } differencing_loglinear;
  struct Independent {
    double loglinear_unit_slope, loglinear_exact, half_unit_slope, half_exact;
  } independent;
  struct Bootstrap {
    double mean, sd, q025, q975;
  } bootstrap;
};

std::span<const DetectionCase> detection_cases() noexcept;

}  // namespace jnd
