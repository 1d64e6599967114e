// One effect of a within-subject design, from the participants' scores on orthonormal contrasts: F test, sphericity,
// epsilons. One-way and two-way analyses are sets of such effects.
//
// Source: Maxwell and Delaney 2004, chapters 11 and 12. Mauchly 1940, Annals of Mathematical Statistics 11, 204-209,
// with the second-order p of Anderson 1958, section 10.7.4 (exact for two contrasts: p = W^((n-2)/2)). As R 4.2.2's
// mauchly.test, which for more contrasts has 3 k in one term where Anderson has 3 (k - 1): p = 0.30055 for 0.30049 with
// k = 4, n = 11. Greenhouse and Geisser 1959; Huynh and Feldt 1976 (uncapped; capped at 1 for its p, as car does).
// Accuracy: 1e-12 relative in F and W where the data have the digits. Tests: R 4.2.2 with car and afex.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "analysis/group/within_table.h"
#include "analysis/numerics/statistic_status.h"

namespace jnd {

struct Mauchly {
  double w = 0, p = 0;  // W in 0..1; small p: no sphericity
  // else not_applicable (one contrast), singular, too_few (n < 2), no_variance
  StatisticStatus status = StatisticStatus::ok;
};

struct WithinEffect {
  double ss = 0, ss_error = 0;  // sums of squares
  double f = 0;
  double df1 = 0, df2 = 0;  // contrasts, contrasts * (n - 1)
  double p = 0;             // assuming sphericity
  double epsilon_gg = 0;    // 1/contrasts .. 1
  double epsilon_hf = 0;    // uncapped: may exceed 1; NaN where 0/0 (n = 2 and more than one contrast)
  double p_gg = 0, p_hf = 0;
  double p_lower_bound = 0;  // with epsilon = 1/contrasts
  double eta2_partial = 0;   // ss / (ss + ss_error)
  Mauchly mauchly;
  // Hotelling's one-sample T2 of the contrasts: the multivariate test, which needs no sphericity.
  double hotelling_t2 = 0, hotelling_f = 0, hotelling_df1 = 0, hotelling_df2 = 0, hotelling_p = 0;
  StatisticStatus hotelling_status = StatisticStatus::ok;  // else too_few, singular, no_variance
  // else too_few (n < 2) or no_variance (no error beyond rounding: F is 0/0 or infinite; f and every p are NaN)
  StatisticStatus status = StatisticStatus::ok;
};

// scores: n x contrasts, row-major; scale: the largest |value| of the data, which says what rounding is.
WithinEffect within_effect(std::span<const double> scores, std::size_t n, std::size_t contrasts, double scale);

// Orthonormal (Helmert) contrasts of k levels: (k - 1) x k, row-major; each row sums to 0.
std::vector<double> helmert_contrasts(std::size_t k);

// One-way repeated-measures analysis of variance.
//
// Source: Maxwell and Delaney 2004, chapter 11; Olejnik and Algina 2003 for the generalised eta squared; Kirk 1996 for
// omega squared. Accuracy and tests: as above; R 4.2.2 with car and afex.
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

// Two-way analysis of variance with both factors within subjects, such as condition x series.
//
// Source: Maxwell and Delaney 2004, chapter 12: each effect against its own interaction with the participants.
// Olejnik and Algina 2003 for the generalised eta squared: all error terms and the participants in the denominator.
// Accuracy: as above. Tests: sums of squares of an independent computation by cell means; one-way special cases.

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
