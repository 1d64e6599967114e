// The results of a study as tables a person likes to read, and as JSON.
#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "data/results/study_models.h"
#include "data/results/study_results.h"
#include "protocols/protocol.h"
#include "runner/results/result_tables.h"

namespace jnd {

// Ends with an empty line. Tables are as wide as they are where standard output is no terminal, and fit a terminal's
// width; text between them has 80 columns, or the fewer that there are.
std::string text_of(const ResultTable& table);
// Its words in lines, each ended. style: of each line, such as bold; none where null.
std::string paragraph(const std::string& text, std::string_view indent = "",
                      std::string (*style)(std::string_view) = nullptr);
// What the study found: the answer's tables (answer_tables.h) and the verdict. Ends with an empty line.
std::string answer_text(const StudyResults& results, const Protocol& protocol);
// Deviations from the plan, then cautions; nothing where there are none.
std::string cautions_text(const StudyResults& results);

// Of every session: how its chain of events ends.
nlohmann::ordered_json heads_json(const Attendance& attendance);
nlohmann::ordered_json to_json(const StudyAnalysis& analysis, const Protocol& protocol);
nlohmann::ordered_json to_json(const StudyResults& results, const Protocol& protocol);
nlohmann::ordered_json task_json(const StudyResults& results, const TaskResults& measured, const Protocol& protocol);
nlohmann::ordered_json to_json(const StudyModels& models, const Protocol& protocol);

}  // namespace jnd
