// The blocks of a study's results, in the order in which they are read. Of every task and whatever sets its levels: a block
// without rows is left out.
#pragma once

#include <string>
#include <vector>

#include "data/fields/block.h"
#include "data/results/study_models.h"
#include "data/results/study_results.h"
#include "protocols/protocol.h"

namespace jnd {

// What they are made of must outlive them. models: every model beside the registered one; none where null.
std::vector<Block> result_blocks(const StudyResults& results, const Protocol& protocol,
                                 const StudyModels* models = nullptr);

// The parts of it, each by what it is about; some may have no rows.
using Blocks = std::vector<Block>;
Blocks estimate_blocks(const StudyResults& results, const Protocol& protocol);  // people, tracks, group, counts
Blocks count_blocks(const StudyResults& results, const Protocol& protocol);     // cells, counts, curves, proportion
Blocks test_blocks(const StudyResults& results, const Protocol& protocol);      // contrasts, groups, conditions, pairs
Blocks hierarchical_blocks(const StudyResults& results, const Protocol& protocol);
Blocks model_blocks(const StudyResults& results, const Protocol& protocol, const StudyModels* models);
Blocks behaviour_blocks(const StudyResults& results, const Protocol& protocol);
Blocks question_blocks(const StudyResults& results, const Protocol& protocol);

// Where the fit rests on another difference than the one asked for; empty where it does not.
std::string source_caution(DifferenceSource source, const TaskResults& task);

}  // namespace jnd
