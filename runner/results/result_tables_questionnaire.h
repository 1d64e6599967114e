// Tables and JSON of a study of free interaction: items, tests, choices, times.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "data/results/questionnaire_results.h"
#include "protocols/protocol.h"
#include "runner/results/result_tables.h"

namespace jnd {

// What each of Protocol::conditions is called in a result.
std::vector<std::string> condition_names(const Protocol& protocol);

// Tables without rows are left out.
std::vector<ResultTable> questionnaire_tables(const QuestionnaireResults& results,
                                              const ExplorationResults& exploration, const Protocol& protocol);
nlohmann::ordered_json to_json(const QuestionnaireResults& results, const ExplorationResults& exploration,
                               const Protocol& protocol);

}  // namespace jnd
