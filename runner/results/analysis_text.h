// The results of a study as a person reads them, and as JSON.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "data/fields/block.h"
#include "data/results/study_results.h"
#include "protocols/protocol.h"
#include "runner/results/block_output.h"

namespace jnd {

// What the study found: the answer's tables and the verdict. Ends with an empty line.
std::string answer_text(const StudyResults& results, const std::vector<Block>& blocks, const Protocol& protocol);
// Deviations from the plan, then cautions; nothing where there are none.
std::string cautions_text(const StudyResults& results);
// "18 simulated participants (18 planned)".
std::string who_took_part(const StudyResults& results, const Protocol& protocol);

// What the results are of, the verdict and the cautions, and every block under its id.
nlohmann::ordered_json to_json(const StudyResults& results, const std::vector<Block>& blocks, const Protocol& protocol);

}  // namespace jnd
