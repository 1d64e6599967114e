// The registered contrasts, each on the scale on which it is tested, and in JNDs beside it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "analysis/group/group.h"
#include "analysis/numerics/special_values.h"
#include "data/results/study_analysis.h"
#include "data/results/study_comparisons.h"
#include "data/results/study_hierarchical.h"
#include "protocols/protocol.h"

namespace jnd {

// The scale of the hierarchical model's contrasts, and what they are tested by.
inline constexpr std::string_view kHierarchicalScale = "hierarchical_log_jnd";
inline constexpr std::string_view kHierarchicalTest = "hierarchical-lr-holm";

// One contrast on one scale. Difference, interval and p of a row are all of that scale.
struct ContrastRow {
  int a = 0, b = 0;         // places in Protocol::conditions
  std::string outcome;      // "slope", "jnd", "log_jnd", "threshold" or kHierarchicalScale
  std::string unit;         // of the difference; empty for none
  bool registered = false;  // the scale of the registered tests: the row has their p
  int participants = 0;     // of all who get both; difference.n says how many have both values
  // Of a - b within participants; its interval is Student's, without correction. Of kHierarchicalScale: ln of the ratio
  // of JNDs with its profile interval, which may be open; without standard deviation.
  MeanEstimate difference;
  double p = kNaN;      // the registered one; NaN where there is none
  std::string refused;  // why a registered row has no p; empty where it has
  DifferenceSource difference_source = DifferenceSource::nominal;
};

// By contrast: the registered scale, then the JND where that is another one. registered: the comparison of the
// registered outcome.
std::vector<ContrastRow> contrast_rows(const std::vector<ContrastResult>& jnds, const OutcomeComparison& registered,
                                       const Protocol& protocol);

// Where the hierarchical model is registered: its row before the others of each contrast, which have no p then. rows:
// those of contrast_rows().
std::vector<ContrastRow> hierarchical_contrasts(const std::vector<ContrastRow>& rows, const StudyHierarchical& model,
                                                const Protocol& protocol);

}  // namespace jnd
