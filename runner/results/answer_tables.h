// What a study found, in the few lines that `analyze` and the report's page begin with: the registered outcome of each
// condition, and the registered contrasts on the scale on which they are tested.
#pragma once

#include <string>
#include <vector>

#include "data/results/study_results.h"
#include "protocols/protocol.h"
#include "runner/results/result_tables.h"

namespace jnd {

// The conditions, the contrasts, the groups of participants: of each the table, where it has rows. Of free interaction
// the ratings. At most 80 columns wide as text, unless names are long.
std::vector<ResultTable> answer_tables(const StudyResults& results, const Protocol& protocol);

// "18 simulated participants (18 planned)".
std::string who_took_part(const StudyResults& results, const Protocol& protocol);

}  // namespace jnd
