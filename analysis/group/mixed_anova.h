// Analysis of variance with groups of participants (between subjects), with or without conditions that every one of them
// has (within subjects).
//
// Source: Maxwell and Delaney 2004, chapters 3 and 12. Sums of squares are those of R's
//   aov(value ~ group * condition + Error(participant / condition)):
// groups against the participants within groups; conditions, then group x condition, against condition x participants
// within groups. Groups of unequal size: type I in that order, as aov: the conditions are compared with every participant
// weighing the same, so the larger group decides more, where type III has equal groups. Greenhouse and Geisser 1959;
// Huynh and Feldt 1976 with Lecoutre's (1991) correction for groups, as car; both of the pooled covariance of the groups.
// Accuracy: 1e-11 relative. Tests: a second computation by regression on dummy variables; t tests where there are two.
#pragma once

#include <cstddef>
#include <vector>

#include "analysis/group/within_table.h"
#include "analysis/numerics/statistic_status.h"

namespace jnd {

// One participant a row of values; group[i] = 0..groups - 1 is that of row i.
struct GroupedTable {
  WithinTable values;  // k = 1: one value for each participant
  std::vector<std::size_t> group;
  std::size_t groups = 0;

  std::vector<double> cell(std::size_t of_group, std::size_t condition) const;
};

struct MixedEffect {
  double ss = 0, ss_error = 0;
  double df1 = 0, df2 = 0;
  double f = 0, p = 0;
  double p_gg = 0, p_hf = 0;    // of what is within; NaN of the groups
  double eta2_partial = 0;      // ss / (ss + ss_error)
  double eta2_generalised = 0;  // both error terms in the denominator (Olejnik and Algina 2003); NaN for k = 1
  // else too_few (no degrees of freedom), no_variance (no error beyond rounding): f, p and effect sizes NaN
  StatisticStatus status = StatisticStatus::ok;
};

struct MixedAnova {
  MixedEffect group, condition, interaction;     // the last two too_few where k = 1
  double epsilon_gg = 0, epsilon_hf = 0;         // 1/(k-1)..1, uncapped (capped for p_hf); NaN where undefined
  std::vector<int> sizes;                        // participants of each group
  bool unequal = false;                          // the groups' sizes differ: see above
  StatisticStatus status = StatisticStatus::ok;  // else too_few: fewer than two groups with a participant
};
MixedAnova mixed_anova(const GroupedTable& given);

}  // namespace jnd
