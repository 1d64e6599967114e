// The columns of items.csv, choices.csv and exposure.csv: numbers for machines, unrounded.
#pragma once

#include <vector>

#include "data/questionnaire_results.h"
#include "data/result_columns.h"
#include "protocols/protocol.h"

namespace jnd {

// Files without rows are left out. The tests of paired items are in ratings.csv.
std::vector<ResultFile> questionnaire_files(const QuestionnaireResults& results, const Protocol& protocol);

}  // namespace jnd
