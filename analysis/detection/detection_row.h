// All that the four counts of one cell say about sensitivity, model by model: what `jnd calc sdt` prints.
#pragma once

#include "analysis/detection/counts.h"
#include "analysis/detection/differencing.h"
#include "analysis/detection/dprime_intervals.h"
#include "analysis/detection/independent_observation.h"
#include "analysis/detection/yes_no.h"

namespace jnd {

// Under `missing` every number is NaN. Under no_information what is named after a correction still holds the arithmetic
// of the corrected rates, models on raw counts are NaN, and the profile is -inf..inf.
struct DetectionRow {
  Counts counts;
  RateStatus status = RateStatus::missing;
  YesNo none, loglinear, half;  // the yes-no model under each correction
  DprimeProfile profile;        // the yes-no model on raw counts
  Differencing differencing;    // on raw counts
  DifferencingFit differencing_loglinear;
  IndependentObservation independent_loglinear, independent_half;
  DprimeBootstrap bootstrap;  // of the yes-no d' of log-linear rates
};

// 0 <= hits <= n_diff, 0 <= false_alarms <= n_same.
DetectionRow detection_row(const Counts& counts);

}  // namespace jnd
