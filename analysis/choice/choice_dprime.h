// d' of a task with a right answer from the count of right answers: maximum likelihood, standard error and
// profile-likelihood interval.
//
// se = sqrt(pc (1 - pc) / n) / P'(d'), the delta method. The interval holds every d' with
// 2 (log L - log L(P(d'))) <= 3.84146 (95 %): it has ends where a standard error has no meaning, at 0 or all right.
// Where d' cannot be negative the likelihood is that of max(pc, chance).
//
// Source: Brockhoff and Christensen 2010, Food Qual Pref 21:330 (sensR); Venzon and Moolgavkar 1988. Checked against:
// R 4.2.2 with sensR and psyphy, d' 1e-6, interval 1e-5; plain search by bisection, 1e-9.
#pragma once

#include <string_view>

#include "analysis/choice/choice_task.h"
#include "analysis/detection/yes_no.h"

namespace jnd {

enum class ChoiceStatus {
  ok,
  ceiling,           // every answer was right: d' is infinite
  floor,             // none was, where d' is signed: d' is minus infinity
  not_above_chance,  // no more right answers than by chance, where d' is not signed: d' is 0
  missing            // no trial
};
std::string_view to_string(ChoiceStatus status) noexcept;

// NaN where there is no number: everything under `missing`, se under every status but ok.
struct ChoiceDprime {
  ChoiceStatus status = ChoiceStatus::missing;
  int n = 0, correct = 0;
  double pc;  // proportion of right answers
  double dprime;
  double se;
  double log_likelihood;   // without binomial constants
  double ci_low, ci_high;  // 95 %; low 0 where d' is not signed and chance is inside; infinite with d'
};

// correct of n answers were right; 0 <= correct <= n.
ChoiceDprime choice_dprime_of_counts(ChoiceTask task, int correct, int n) noexcept;

// d' of tasks that ask for one of two answers, from hits and false alarms: ABX, and yes-no or 2AFC after a reminder.
// Two rates tell sensitivity from the preference for one answer; a proportion of right answers does not.
//
//   zd = z(H) - z(F)
//   ABX                       proportion right of an unbiased observer p = Phi(zd / 2), then d' with P(d') = p of
//                             choice_task.h, by differencing or independent observations; 0 for p <= 1/2
//   reminder, one interval    the standard, then one stimulus: d' = zd where the reminder is ignored,
//                             sqrt 2 zd where the two are compared (differencing)
//   reminder, two intervals   the standard, then both stimuli: d' = zd / sqrt 2 for either strategy
//
// Intervals: the profile-likelihood interval of zd (dprime_intervals.h), carried over.
//
// Source: Macmillan and Creelman 2005, chapters 7 and 9; Hautus, Van Hout and Lee 2009, Food Qual Pref 20:97.
// Checked against: R 4.2.2, sensR, 1e-6.
enum class RatesTask { abx, reminder_one_interval, reminder_two_intervals };

// NaN where the rates give none: zd of two rates of 0 or of 1.
struct TwoRates {
  double hit_rate, false_alarm_rate;
  double z_difference;
  double pc_unbiased;  // Phi(zd / 2); NaN for reminder_one_interval, which has no such number
  double dprime_differencing, dprime_independent;  // ABX: >= 0; otherwise signed
};

// status: missing without a trial of one class, no_information where all answers are alike. Everything is NaN under
// missing; the interval is the whole range under no_information.
struct RatesDprime {
  RateStatus status = RateStatus::missing;
  Counts counts;
  TwoRates raw, loglinear;
  double se_z_difference;  // Gourevitch and Galanter, of the log-linear rates
  // 95 %, of the raw counts.
  double z_difference_low, z_difference_high;
  double differencing_low, differencing_high, independent_low, independent_high;
};

// n_diff, hits: trials with the signal (ABX: X was A) and how many of them were answered so; n_same, false_alarms: the
// trials without (X was B), and how many of them were answered as if there were one.
RatesDprime dprime_of_rates(RatesTask task, const Counts& counts) noexcept;

}  // namespace jnd
