// The registered contrasts, each on the scale on which it is tested, and in JNDs beside it.
#pragma once

#include <string>
#include <vector>

#include "analysis/group/group.h"
#include "analysis/numerics/special_values.h"
#include "data/results/study_analysis.h"
#include "data/results/study_comparisons.h"
#include "protocols/protocol.h"

namespace jnd {

// One contrast on one scale. Difference, interval and p of a row are all of that scale.
struct ContrastRow {
  int a = 0, b = 0;         // places in Protocol::conditions
  std::string outcome;      // "slope", "jnd", "log_jnd" or "threshold"
  std::string unit;         // of the difference; empty for none
  bool registered = false;  // the scale of the registered tests: the row has their p
  int participants = 0;     // of all who get both; difference.n says how many have both values
  MeanEstimate difference;  // of a - b within participants; its interval is Student's, without correction
  double p = kNaN;          // the registered one; NaN where there is none
  std::string refused;      // why a registered row has no p; empty where it has
  DifferenceSource difference_source = DifferenceSource::nominal;
};

// By contrast: the registered scale, then the JND where that is another one. registered: the comparison of the
// registered outcome.
std::vector<ContrastRow> contrast_rows(const std::vector<ContrastResult>& jnds, const OutcomeComparison& registered,
                                       const Protocol& protocol);

}  // namespace jnd
