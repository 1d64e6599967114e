// Does performance change over the session? d' and criterion of its first and second half.
#pragma once

#include <span>

#include "analysis/behaviour/judged_trial.h"
#include "analysis/detection/yes_no.h"

namespace jnd {

// A quantity in both halves. Log-linear rates, yes-no model, all differences pooled.
struct HalfDifference {
  double first = 0, second = 0;
  // second - first, with its Wald interval, 95 %, and the two-sided p that belongs to it (variances of Gourevitch and Galanter
  // 1967, added). p is NaN where a half has one answer throughout.
  double difference = 0, se = 0, ci_low = 0, ci_high = 0, p = 0;
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

// The change of d' over several strata, such as the series of a study, each with trials in both halves: a stratum that
// happened to come early is compared with itself only.
struct StratifiedDrift {
  int strata = 0;  // with both classes in both halves
  // Mean over the strata, weighted by 1/variance, with its Wald interval, 95 %, and two-sided p. NaN for no stratum.
  double difference = 0, se = 0, ci_low = 0, ci_high = 0, p = 0;
};
StratifiedDrift stratified_drift(std::span<const Drift> strata);

}  // namespace jnd
