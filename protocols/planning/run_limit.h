// Sequences of two classes in which no class comes more than so many times in a row.
#pragma once

#include <vector>

#include "protocols/random_stream.h"

namespace jnd {

// A sequence of `same` trues and `different` falses with no run longer than `limit`, drawn uniformly among all such
// sequences: the numbers of completions are counted first (dynamic programming over what is left, in double: the same
// on every machine), then the runs are drawn one after another in proportion to them.
// Throws std::invalid_argument where there is no such sequence, or beyond 1000 trials (counts leave double's range).
std::vector<bool> draw_limited_sequence(int same, int different, int limit, RandomStream& stream);

}  // namespace jnd
