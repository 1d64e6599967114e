// Does performance change over the session? d' and criterion of its first and second half.
#pragma once

#include <span>

#include "analysis/judged_trial.h"
#include "analysis/yes_no.h"

namespace jnd {

// A quantity in both halves. Log-linear rates, yes-no model, all differences pooled.
struct HalfDifference {
  double first = 0, second = 0;
  // second - first, with its Wald interval, 95 % (variances of Gourevitch and Galanter 1967, added).
  double difference = 0, se = 0, ci_low = 0, ci_high = 0;
  // Likelihood-ratio test of "the same in both halves", the other quantity free in each; raw counts, chi-square with 1
  // degree of freedom. 1 where a half has one answer throughout, which fits anything.
  double p = 0;
};

struct Drift {
  // ok; missing where a half lacks a class of trials (everything is NaN); no_information where one answer was given
  // throughout a half (the differences are the arithmetic of the log-linear rates).
  RateStatus status = RateStatus::missing;
  Counts first, second;
  HalfDifference dprime, criterion;
};

Drift drift(const Counts& first, const Counts& second);
// The first half: time_fraction < 0.5.
Drift drift(std::span<const JudgedTrial> trials);

}  // namespace jnd
