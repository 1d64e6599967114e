// Would the conclusion change under another model, method or correction? The registered tests, once for each.
#pragma once

#include <string>
#include <vector>

#include "data/task_results/task_results.h"
#include "protocols/protocol.h"

namespace jnd {

struct SensitivityRow {
  ThresholdMethod method;
  bool registered = false;
  std::vector<TaskGroupRow> group;     // of the JND, by condition
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

// Of pairs at given levels; the registered method first. Tests run on what the plan registers (slope, JND or its logarithm).
std::vector<SensitivityRow> study_sensitivity(const TaskResults& results, const Protocol& protocol);

}  // namespace jnd
