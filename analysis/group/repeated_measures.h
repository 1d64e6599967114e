// One-way repeated-measures analysis of variance.
//
// Source: Maxwell and Delaney 2004, chapter 11; Olejnik and Algina 2003 for the generalised eta squared; Kirk 1996 for
// omega squared. Accuracy and tests: within_effect.h; R 4.2.2 with car and afex.
#pragma once

#include <vector>

#include "analysis/group/within_effect.h"
#include "analysis/group/within_table.h"

namespace jnd {

struct RepeatedMeasures {
  WithinEffect effect;  // of the conditions: SS, F, p, epsilons, Mauchly, Hotelling
  double ss_subjects = 0;
  double eta2_generalised = 0;  // SS / (SS + SS error + SS subjects)
  double omega2_partial = 0;    // df1 (F - 1) / (df1 (F - 1) + n k)
  double cohen_f = 0;           // sqrt(SS / SS error)
  // x - participant's mean - condition's mean + grand mean, n x k row-major: what is to be normal.
  std::vector<double> residuals;
  // else too_few (n < 2 or k < 2), no_variance: effect.f, every p and omega2 are NaN, the sums of squares stand
  StatisticStatus status = StatisticStatus::ok;
};
RepeatedMeasures repeated_measures(const WithinTable& table);

}  // namespace jnd
