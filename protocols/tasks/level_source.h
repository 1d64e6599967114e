// Who sets the levels of a study: the protocol gives them, or a procedure moves them by the answers. What depends on that
// is asked here or of AdaptiveRun.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "protocols/protocol.h"

namespace jnd {

// Whether the protocol gives the levels.
bool levels_given(const Protocol& protocol) noexcept;

// Sides of the standard on which comparisons lie, each once: -1 below, 1 above, 0 at it or across it.
std::vector<int> sides_of_comparisons(const Protocol& protocol, const Series& series);

// The given levels; of a procedure the comparisons furthest from the standard.
std::vector<double> extreme_comparisons(const Protocol& protocol, const Series& series);

// From a standard to its furthest level, given or that a procedure may come to; of pairs between their two.
double largest_difference(const Protocol& protocol);

// Of the trials of a procedure, those without a difference or a signal; 0 where the levels are given.
double catch_share(const Protocol& protocol) noexcept;

// Words for a condition's cells or tracks: "1 standard x 8 levels x 10 trials per cell", "2 tracks".
std::string cells_text(const Protocol& protocol);

// The share of catch trials, behind the number of trials: ", 50 % of them catch trials"; empty where the levels are given.
std::string catch_words(const Protocol& protocol);

// "levels of the protocol" or "levels set by the procedure".
std::string_view level_words(const Protocol& protocol) noexcept;

}  // namespace jnd
