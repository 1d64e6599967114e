// What the registered tests came to, in sentences: worded from their numbers alone, and never saying more than they do.
#pragma once

#include <string>

#include "data/results/study_results.h"
#include "protocols/protocol.h"

namespace jnd {

// One paragraph of plain text. A difference is named only where its registered p is below the registered alpha, and has
// a direction only where the test is one of means; what is not significant is not called equal; what could not be tested
// is counted. Of free interaction: how many tests of the ratings fall below alpha. Empty where nobody took part, or
// where there is nothing to compare.
std::string verdict_text(const StudyResults& results, const Protocol& protocol);

// ".141"; with more digits where three would show the p on the other side of alpha: ".0498"; "< .001" where alpha is not. p,
// alpha: 0..1.
std::string p_in_words(double p, double alpha);

}  // namespace jnd
