// The differencing model of the same-different task: rates, slopes and likelihood at given parameters.
//
// The observer says "different" where |x1 - x2| > tau, with x_i normal of variance 1 and means d' apart:
//   H = Phi((d' - tau)/sqrt 2) + Phi((-d' - tau)/sqrt 2),   F = 2 Phi(-tau/sqrt 2);   d' >= 0, tau >= 0, both may be
//   inf.
// The model is even in d'.
//
// Source: Macmillan and Creelman 2005, Detection Theory, 2nd ed., chapter 9; the `samediff` of R's sensR.
#pragma once

#include "analysis/detection/counts.h"

namespace jnd {

double differencing_hit_rate(double dprime, double tau) noexcept;
// tau with that F; the complement 1 - F is given apart, so that no digit is lost near 1. inf at F = 0, 0 at F = 1.
double differencing_tau(double false_alarm_rate, double correct_rejection_rate) noexcept;

// All four rates, each with its own digits: also next to 0 and 1 none is the rounded complement of another.
struct DifferencingRates {
  double hit, miss, false_alarm, correct_rejection;
};
DifferencingRates differencing_rates(double dprime, double tau) noexcept;

// Derivatives of H and F.
struct DifferencingSlopes {
  double hit_on_dprime, hit_on_tau, false_alarm_on_tau;
};
DifferencingSlopes differencing_slopes(double dprime, double tau) noexcept;

// Binomial log-likelihood of raw counts, without binomial constants. -inf where the counts are impossible.
double differencing_log_likelihood(const Counts& counts, double dprime, double tau) noexcept;

// The same with its derivatives, for 0 < tau < inf and finite d'.
struct DifferencingLikelihood {
  double value, on_dprime, on_tau, on_tau_twice;
  double information_on_tau;  // expected -d2/dtau2, > 0
  double on_dprime_and_tau;
};
DifferencingLikelihood differencing_likelihood(const Counts& counts, double dprime, double tau) noexcept;

}  // namespace jnd
