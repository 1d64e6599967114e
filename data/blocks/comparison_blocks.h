// Conditions within participants, and groups of participants, compared: the same blocks for a study and for a file.
#pragma once

#include <string>
#include <vector>

#include "data/fields/block.h"
#include "data/results/study_comparisons.h"

namespace jnd {

// Of some outcomes: what each is like under every condition ("conditions"), the tests over all conditions ("tests"), every
// pair ("pairs"), and the values themselves ("values"). names: of the conditions. groups: of the participants, as values
// name them; may be empty.
std::vector<Block> comparison_blocks(const std::vector<OutcomeComparison>& comparisons,
                                     const std::vector<std::string>& names, const std::vector<std::string>& groups);

// Of one outcome: groups under each condition ("groups"), the effects of the analysis of variance ("between") and every
// pair of groups ("group_pairs").
std::vector<Block> group_comparison_blocks(const GroupsCompared& compared, const std::vector<std::string>& groups,
                                           const std::vector<std::string>& conditions);

}  // namespace jnd
