// Everything that a paper reports about groups of participants: descriptives of each group and condition, the analysis
// of variance, and every pair of groups under each condition.
//
// Source: mixed_anova.h, between_groups.h; Holm 1979 (p_adjust.h) over all pairs and conditions. Accuracy and tests:
// theirs.
#pragma once

#include <cstddef>
#include <vector>

#include "analysis/group/between_groups.h"
#include "analysis/group/mixed_anova.h"
#include "analysis/group/shapiro_wilk.h"
#include "analysis/scaling/mean_interval.h"

namespace jnd {

struct GroupCell {
  std::size_t group = 0, condition = 0;
  MeanInterval mean;
  double median = 0;  // NaN without a value
  ShapiroWilk shapiro;
};

// Two groups under one condition. p_holm: over all pairs and conditions of the table; NaN where p is.
struct GroupPair {
  std::size_t a = 0, b = 0, condition = 0;
  WelchT welch;
  double welch_p_holm = 0;
  MannWhitney ranks;
  double ranks_p_holm = 0;
};

struct GroupComparison {
  std::vector<GroupCell> cells;  // by condition, then group
  MixedAnova anova;              // with one condition: one-way between groups
  std::vector<GroupPair> pairs;  // by condition, then (0,1), (0,2), ..., (1,2), ...
};

// table: finite; a group may be empty. Every part has a status of its own; what is undefined is NaN.
GroupComparison compare_groups(const GroupedTable& table);

}  // namespace jnd
