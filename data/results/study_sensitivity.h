// Would the conclusion change under another model, method or correction? The registered tests, once for each.
#pragma once

#include <string>
#include <vector>

#include "data/results/study_analysis.h"
#include "data/results/threshold_method.h"
#include "protocols/protocol.h"

namespace jnd {

struct SensitivityRow {
  ThresholdMethod method;
  bool registered = false;
  // By condition, in the study's unit, as in JndGroup: the median is a number only where its status is ok, or
  // no_sensitivity (inf); the mean is over status ok.
  std::vector<JndStatus> median_status;
  std::vector<double> median_jnd, mean_jnd;
  std::vector<int> n_ok;
  int n = 0;                           // participants in the tests
  int participants = 0;                // of all
  double omnibus_p = 0;                // NaN where there is none
  std::vector<double> contrast_p;      // by registered contrast, adjusted as registered; NaN where there is none
  std::vector<double> contrast_slope;  // mean paired difference of the slopes, a - b
  std::string refused;                 // why there are no tests; empty where there are
  // Every registered test decides as in the registered row: on the same side of alpha and, where significant, with the
  // same sign. False where either was refused.
  bool same_conclusion = false;
};

// The registered method first. Tests run on what the plan registers (slope, JND or its logarithm).
std::vector<SensitivityRow> study_sensitivity(const StudyAnalysis& analysis, const Protocol& protocol);

}  // namespace jnd
