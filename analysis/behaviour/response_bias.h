// Does the participant lean towards one answer? Over all trials together, whatever their difference.
#pragma once

#include <span>

#include "analysis/behaviour/judged_trial.h"
#include "analysis/detection/yes_no.h"

namespace jnd {

struct ResponseBias {
  // ok; missing (no different or no equal pair: criterion NaN); no_information (one answer throughout: the criterion is
  // the arithmetic of the log-linear rates).
  RateStatus status = RateStatus::missing;
  Counts counts;
  // c = -(zH + zF)/2 of the log-linear rates; positive: tends to say "same". Wald interval, 95 %, from the variance of
  // Gourevitch and Galanter (Var c = Var d' / 4). Pooled over differences it is a summary, not the criterion of one
  // series.
  double criterion = 0, se = 0, ci_low = 0, ci_high = 0;
  // How often "different" was said, and how often it would have been true by the plan.
  Share said_different;  // with Clopper and Pearson's interval, to which p belongs
  double planned_share = 0;
  double p = 0;  // two-sided exact binomial test of said_different against planned_share; NaN without trials
};

// planned_share: of different pairs among all trials, 0 < planned_share < 1 (0.5 in Chinello 2017).
ResponseBias response_bias(const Counts& counts, double planned_share);
ResponseBias response_bias(std::span<const JudgedTrial> trials, double planned_share);

}  // namespace jnd
