// The methods of a study of free interaction in words.
#pragma once

#include <string>

#include "data/results/study_results.h"
#include "protocols/protocol.h"

namespace jnd {

// Markdown: the sections Design and Tests. results.questionnaire must have a value.
std::string exploration_design(const Protocol& protocol, const StudyResults& results);
std::string questionnaire_tests(const StudyResults& results);

}  // namespace jnd
