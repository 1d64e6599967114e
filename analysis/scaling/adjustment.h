// The method of adjustment: settings that participants made until a comparison felt like the standard.
//
// The mean setting is the point of subjective equality, its distance from the standard the constant error, and the
// settings' scatter the precision: JND = 0.6745 SD, the half-width that holds half of the settings of a normal
// distribution (Fechner's probable error; Gescheider 1997, Psychophysics, chapter 3). A participant who starts from
// above and from below may stop short on either side: the start effect is the difference of the two means, tested by
// the pooled two-sample t, and the variable error is the scatter within the sides, which it is not part of.
//
// Accuracy: 1e-12 relative. Tests: reference numbers of Python (closed formulas) and R 4.2.2 (t.test).
#pragma once

#include <span>
#include <vector>

#include "analysis/numerics/statistic_status.h"
#include "analysis/scaling/mean_interval.h"

namespace jnd {

inline constexpr double kProbableError = 0.6744897501960817;  // the 75 % quantile of the standard normal distribution

enum class StartSide { unknown, above, below };  // of the standard

struct Setting {
  double value = 0;  // in the unit of the standard, finite
  StartSide start = StartSide::unknown;
};

struct Adjustment {
  MeanInterval settings;      // mean: the PSE
  double constant_error = 0;  // PSE - standard
  double jnd = 0, weber = 0;  // of all settings, both sides together; NaN for fewer than two settings
  // 95 %, of normal settings: kProbableError * sqrt((n - 1) SD^2 / chi^2), the 97.5 and 2.5 % quantiles of n - 1 degrees
  // of freedom. NaN for fewer than two settings.
  double jnd_low = 0, jnd_high = 0;

  // Where both sides occur; else NaN, status not_applicable. Settings whose side is unknown take no part.
  double mean_from_above = 0, mean_from_below = 0, start_effect = 0;  // above - below
  double variable_error = 0, jnd_within_side = 0;  // pooled within-side SD, df n - 2; NaN for one setting a side
  double start_t = 0, start_p = 0;                 // two-sided
  int start_df = 0;
  StatisticStatus start_status = StatisticStatus::not_applicable;
  // of variable_error and start_t; else not_applicable, too_few (one setting a side), no_variance (t alone is NaN)
  StatisticStatus start_test_status = StatisticStatus::not_applicable;
};
// standard > 0, in the unit of the settings.
Adjustment adjustment(std::span<const Setting> settings, double standard);

struct AdjustmentGroup {
  MeanInterval pse, constant_error, jnd;
  MeanTest constant_error_test;  // against 0
  // Of ln JND; undefined, and so are its exponentials, where a participant's JND is 0 or undefined: ln_jnd_status is
  // no_variance or too_few then.
  MeanInterval ln_jnd;
  double jnd_geometric_mean = 0, jnd_geometric_ci_low = 0, jnd_geometric_ci_high = 0;
  StatisticStatus ln_jnd_status = StatisticStatus::ok;
  MeanInterval start_effect;  // over the participants who started from both sides
  MeanTest start_effect_test;
  // else not_applicable: no participant started from both sides
  StatisticStatus start_status = StatisticStatus::ok;
};
AdjustmentGroup adjustment_group(std::span<const Adjustment> participants);

}  // namespace jnd
