// The results of a study as tables a person likes to read, and as JSON.
#pragma once

#include <nlohmann/json.hpp>

#include "data/study_analysis.h"
#include "protocols/protocol.h"

namespace jnd {

void print_participants(const StudyAnalysis& analysis, const Protocol& protocol);
void print_cells(const StudyAnalysis& analysis, const Protocol& protocol);
void print_group(const StudyAnalysis& analysis, const Protocol& protocol);

nlohmann::ordered_json to_json(const StudyAnalysis& analysis, const Protocol& protocol);

}  // namespace jnd
