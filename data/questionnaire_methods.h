// The methods of a study of free interaction in words.
#pragma once

#include <string>

#include "data/study_results.h"
#include "protocols/protocol.h"

namespace jnd {

// Markdown: the sections Design and Tests, and References for the end. results.questionnaire must have a value.
std::string exploration_design(const Protocol& protocol, const StudyResults& results);
std::string questionnaire_tests(const StudyResults& results);
std::string questionnaire_references();

}  // namespace jnd
