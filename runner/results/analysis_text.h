// The results of a study as tables a person likes to read, and as JSON.
#pragma once

#include <nlohmann/json.hpp>

#include "data/results/study_models.h"
#include "data/results/study_results.h"
#include "protocols/protocol.h"
#include "runner/results/result_tables.h"

namespace jnd {

std::string text_of(const ResultTable& table);  // ends with an empty line
void print_table(const ResultTable& table);
// Deviations from the plan, then cautions; nothing where there are none.
void print_cautions(const StudyResults& results);

// Of every session: how its chain of events ends.
nlohmann::ordered_json heads_json(const Attendance& attendance);
nlohmann::ordered_json to_json(const StudyAnalysis& analysis, const Protocol& protocol);
nlohmann::ordered_json to_json(const StudyResults& results, const Protocol& protocol);
nlohmann::ordered_json task_json(const StudyResults& results, const TaskResults& measured, const Protocol& protocol);
nlohmann::ordered_json to_json(const StudyModels& models, const Protocol& protocol);

}  // namespace jnd
