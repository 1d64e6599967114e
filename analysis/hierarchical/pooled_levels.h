// Levels so near each other that nobody could tell count as one: what is computed grows with the number of different ones.
#pragma once

#include <cstddef>
#include <vector>

#include "analysis/hierarchical/hierarchical_likelihood.h"

namespace jnd {

// Of a condition; with more different levels those within 5 % of each other (below a tenth of the largest one within 1 %
// of that) count at the mean of their trials. No difference is one with none.
inline constexpr std::size_t kMostLevels = 64;

// Whether levels were pooled. Of the same level, and half, a person's answers in a condition stand in one cell then.
bool pool_levels(std::vector<HierarchicalCell>& cells);

}  // namespace jnd
