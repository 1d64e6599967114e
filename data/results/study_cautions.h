// What a reader must know before believing the numbers: where the study departs from what was registered, and where
// its design cannot carry a number.
#pragma once

#include <string>
#include <vector>

#include "data/results/study_results.h"
#include "protocols/protocol.h"

namespace jnd {

// One sentence each: another axis than the registered one, sessions that are not finished, participants or trials that
// the plan has and the study has not, tests that were refused.
std::vector<std::string> deviations_of(const StudyResults& results, const Protocol& protocol);

// One sentence each: too few trials, rates of 0 and 1, participants without a JND, JNDs outside the tested differences,
// saturated stimuli, distributions that the registered test does not suit.
std::vector<std::string> cautions_of(const StudyResults& results, const Protocol& protocol);

}  // namespace jnd
