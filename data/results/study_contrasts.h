// The registered contrasts, each on the scale on which it is tested, and in JNDs beside it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "analysis/group/group.h"
#include "analysis/numerics/special_values.h"
#include "data/results/study_comparisons.h"
#include "data/results/study_hierarchical.h"
#include "data/task_results/task_results.h"
#include "protocols/protocol.h"

namespace jnd {

// The scale of the hierarchical model's contrasts, and what they are tested by.
inline constexpr std::string_view kHierarchicalScale = "hierarchical_ln_jnd";
inline constexpr std::string_view kHierarchicalTest = "hierarchical-lr-holm";

// One contrast on one scale. Everything of a row is of that scale.
struct ContrastRow {
  int a = 0, b = 0;              // places in Protocol::conditions
  std::string outcome;           // as OutcomeComparison, or kHierarchicalScale
  std::string title, unit;       // of the difference; no unit: empty
  std::string standard = "all";  // as OutcomeComparison
  bool registered = false;       // the scale of the registered tests: the row has their p
  int participants = 0;          // of all who get both; difference.n says how many have both values
  // Of a - b within participants, with Student's interval. Of kHierarchicalScale: ln of the ratio of JNDs with its profile
  // interval, which may be open; without standard deviation.
  MeanEstimate difference;
  double p = kNaN;             // of the same: Student's t, or the likelihood ratio; without correction
  double p_registered = kNaN;  // by the registered test, corrected as registered; NaN where there is none
  std::string refused;         // why a registered row has no p_registered; empty where it has
  DifferenceSource difference_source = DifferenceSource::nominal;
};

// On the registered scale. registered: the comparison of the registered outcome.
std::vector<ContrastRow> contrast_rows(const OutcomeComparison& registered, const Protocol& protocol);

// By contrast: on the registered scale, and on that of the JND where the task has one and that is another. model: where
// it is registered, its row comes first, and the others have no p_registered.
std::vector<ContrastRow> contrast_rows(const TaskResults& task, const OutcomeComparison& registered,
                                       const StudyHierarchical* model, const Protocol& protocol);

}  // namespace jnd
