// What two-interval choices tend to as s -> 0: steps. Below a threshold the comparison is chosen in l/2 of the trials,
// above it in 1 - l/2, and on it, where the threshold is a level, at any rate between. With an order term each order has a
// threshold of its own, and the PSE is the middle of the two. Of two_interval.h only.
#pragma once

#include <optional>

#include "analysis/choice/choice_likelihood.h"

namespace jnd {

struct ChoiceLimit {
  double value = -kInf;  // the supremum of the log-likelihood over all steps (or constants)
  double lapse = 0;
  // Steps: the PSEs that reach it, in t: an open interval, or a point (low == high). Infinite ends where one order has
  // its threshold outside the levels.
  double low = -kInf, high = kInf;
  std::optional<double> b;  // infinite where the thresholds differ; none where more than one value reaches it
};

// The best step; with an order term the best pair. lapse: fixed, or none (0..kLargestChoiceLapse).
ChoiceLimit best_step(const ChoiceData& data, bool with_order, const std::optional<double>& lapse);
// The best step whose PSE is t; value -inf where there is none.
double best_step_at(const ChoiceData& data, bool with_order, const std::optional<double>& lapse, double t);

// The best constant (with an order term: one for each order), which is 1/s = 0: between l/2 and 1 - l/2.
ChoiceLimit best_constant(const ChoiceData& data, bool with_order, const std::optional<double>& lapse);
// The best constant of at most 1/2 (side < 0) or of at least 1/2 (side > 0): what remains as the PSE goes to +inf, or
// -inf. With an order term eta = a + b o with a of that sign.
double best_constant_beside(const ChoiceData& data, bool with_order, const std::optional<double>& lapse, int side);

}  // namespace jnd
