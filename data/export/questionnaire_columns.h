// The files of the answers to questions: numbers for machines, unrounded.
#pragma once

#include <vector>

#include "data/export/result_columns.h"
#include "data/results/questionnaire_results.h"
#include "protocols/protocol.h"

namespace jnd {

// items.csv of any paradigm; no file without rows. The tests of paired items are in ratings.csv.
void add_items_file(std::vector<ResultFile>& files, const std::vector<QuestionnaireItem>& items,
                    const Protocol& protocol);
// choices.csv and exposure.csv of free interaction. Files without rows are left out.
std::vector<ResultFile> questionnaire_files(const QuestionnaireResults& results, const Protocol& protocol);

}  // namespace jnd
