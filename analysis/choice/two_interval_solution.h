// A two-interval fit with what its profile intervals start from. Of two_interval.h only.
#pragma once

#include <span>

#include "analysis/choice/choice_steps.h"

namespace jnd {

struct TwoIntervalSolution {
  TwoIntervalOptions options;  // order_term: only where both orders have trials
  ChoiceData data;
  ChoiceBox box{};
  ChoiceLimit constant, step;  // the limits s -> inf and s -> 0
  ChoicePeak peak;             // the maximum of those between; under separated and flat not always looked for
  TwoIntervalFit fit;
};

// Throws std::invalid_argument as fit_two_interval.
TwoIntervalSolution solve_two_interval(std::span<const ChoiceRow> rows, const TwoIntervalOptions& options);

// The global maximum in the box: one climb without lapses, from the peaks of a survey with them.
ChoicePeak solve_choice(const ChoiceData& data, const ChoiceBox& box, const ChoicePlace& start, double pivot);

}  // namespace jnd
