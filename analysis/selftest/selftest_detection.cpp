// `jnd calc selftest`, signal detection.
#include "analysis/detection/detection_row.h"
#include "analysis/selftest/selftest.h"
#include "analysis/selftest/selftest_detection_cases.h"

namespace jnd {

namespace {

SelftestQuantity quantity(const char* name, double tolerance) {
  SelftestQuantity result;
  result.name = name;
  result.tolerance = tolerance;
  return result;
}

void compare_yes_no(SelftestQuantity& scores, SelftestQuantity& errors, const YesNo& ours,
                    const DetectionCase::YesNo& reference) {
  scores.absolute(ours.dprime, reference.dprime);
  scores.absolute(ours.criterion, reference.criterion);
  scores.absolute(ours.ln_beta, reference.ln_beta);
  errors.absolute(ours.se, reference.se);
  errors.absolute(ours.ci_low, reference.ci_low);
  errors.absolute(ours.ci_high, reference.ci_high);
}

}  // namespace

std::vector<SelftestQuantity> selftest_detection() {
  SelftestQuantity scores = quantity("yes-no d', c, ln beta", 1e-10);
  SelftestQuantity errors = quantity("yes-no standard error and Wald interval", 1e-10);
  SelftestQuantity profile = quantity("yes-no profile interval", 1e-6);
  SelftestQuantity likelihood = quantity("log-likelihood of yes-no and differencing", 1e-10);
  SelftestQuantity differencing = quantity("differencing d', tau and errors", 1e-8);
  SelftestQuantity differencing_profile = quantity("differencing profile interval", 1e-6);
  SelftestQuantity p_value = quantity("differencing p of d' = 0", 1e-9);
  SelftestQuantity rates = quantity("differencing d', tau of log-linear rates", 1e-8);
  SelftestQuantity unit_slope = quantity("independent observation, unit slope", 1e-10);
  SelftestQuantity exact = quantity("independent observation, likelihood ratio", 1e-6);
  SelftestQuantity bootstrap = quantity("exact bootstrap of d'", 1e-10);
  for (const DetectionCase& one : detection_cases()) {
    const DetectionRow row = detection_row(one.counts);
    compare_yes_no(scores, errors, row.none, one.none);
    compare_yes_no(scores, errors, row.loglinear, one.loglinear);
    compare_yes_no(scores, errors, row.half, one.half);
    scores.absolute(row.profile.dprime, one.profile.dprime);
    profile.absolute(row.profile.ci_low, one.profile.ci_low);
    profile.absolute(row.profile.ci_high, one.profile.ci_high);
    likelihood.absolute(row.profile.log_likelihood, one.profile.log_likelihood);
    const DifferencingFit& fit = row.differencing.fit;
    likelihood.absolute(fit.log_likelihood, one.differencing.log_likelihood);
    differencing.absolute(fit.dprime, one.differencing.dprime);
    differencing.absolute(fit.se_dprime, one.differencing.se_dprime);
    if (one.differencing.tau > 0) {
      differencing.absolute(fit.tau, one.differencing.tau);
      differencing.absolute(fit.se_tau, one.differencing.se_tau);
    }
    differencing_profile.absolute(row.differencing.ci_low, one.differencing.ci_low);
    differencing_profile.absolute(row.differencing.ci_high, one.differencing.ci_high);
    p_value.absolute(row.differencing.p_value, one.differencing.p_value);
    rates.absolute(row.differencing_loglinear.dprime, one.differencing_loglinear.dprime);
    rates.absolute(row.differencing_loglinear.tau, one.differencing_loglinear.tau);
    unit_slope.absolute(row.independent_loglinear.unit_slope, one.independent.loglinear_unit_slope);
    unit_slope.absolute(row.independent_half.unit_slope, one.independent.half_unit_slope);
    exact.absolute(row.independent_loglinear.exact, one.independent.loglinear_exact);
    exact.absolute(row.independent_half.exact, one.independent.half_exact);
    bootstrap.absolute(row.bootstrap.mean, one.bootstrap.mean);
    bootstrap.absolute(row.bootstrap.sd, one.bootstrap.sd);
    bootstrap.absolute(row.bootstrap.q025, one.bootstrap.q025);
    bootstrap.absolute(row.bootstrap.q975, one.bootstrap.q975);
  }
  return {scores,  errors, profile,    likelihood, differencing, differencing_profile,
          p_value, rates,  unit_slope, exact,      bootstrap};
}

}  // namespace jnd
