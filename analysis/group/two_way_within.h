// Two-way analysis of variance with both factors within subjects, such as condition x series.
//
// Source: Maxwell and Delaney 2004, chapter 12: each effect against its own interaction with the participants.
// Olejnik and Algina 2003 for the generalised eta squared: all error terms and the participants in the denominator.
// Accuracy: within_effect.h. Tests: sums of squares of an independent computation by cell means; one-way special cases.
#pragma once

#include <cstddef>
#include <vector>

#include "analysis/group/within_effect.h"

namespace jnd {

// values.size() == n * a * b, all finite; participant i at levels (j, l) is values[(i * a + j) * b + l].
struct TwoWayTable {
  std::size_t n = 0, a = 0, b = 0;
  std::vector<double> values;
};

struct TwoWayEffect {
  WithinEffect effect;
  double eta2_generalised = 0;
};

struct TwoWayWithin {
  TwoWayEffect a, b, ab;
  double ss_subjects = 0;
  StatisticStatus status =
      StatisticStatus::ok;  // else too_few (n, a or b < 2: all NaN); each effect has its own beside it
};
TwoWayWithin two_way_within(const TwoWayTable& table);

}  // namespace jnd
