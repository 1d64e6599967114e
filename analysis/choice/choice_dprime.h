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

}  // namespace jnd
