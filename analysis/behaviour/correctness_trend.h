// Does correctness change over the session? A logistic trend on the place of the trial.
#pragma once

#include <span>
#include <string_view>

#include "analysis/behaviour/judged_trial.h"

namespace jnd {

enum class TrendStatus {
  ok,
  separated,     // all correct answers on one side of some moment: odds ratio 0 or infinite, no interval; p stands
  no_variation,  // every answer correct, or every one wrong: nothing to explain
  no_times       // fewer than two different moments
};
std::string_view to_string(TrendStatus status) noexcept;

// Logistic regression of correctness on the place in the session: log odds of a correct answer = a + b t, t = 0 (start)
// to 1 (end), by maximum likelihood.
struct CorrectnessTrend {
  TrendStatus status = TrendStatus::no_times;
  int n = 0, correct = 0;
  double intercept = 0;  // a; NaN unless ok
  double slope = 0;      // b, change of the log odds from start to end; +-inf if separated, NaN if not defined
  double se = 0, ci_low = 0, ci_high = 0;  // of b: Wald, 95 %; NaN unless ok
  double p = 0;                            // likelihood-ratio test of b = 0; NaN under no_variation and no_times
};
CorrectnessTrend correctness_trend(std::span<const JudgedTrial> trials);

}  // namespace jnd
