// The arrangements of a level, such as standard first and comparison first, each equally often.
#pragma once

#include <string_view>
#include <vector>

#include "protocols/random_stream.h"
#include "protocols/tasks/task.h"

namespace jnd {

// Adds `trials` of the level: balanced, every arrangement equally often and the rest of the division drawn without
// repetition; random, each trial one of them at random. In no order: shuffle the cell when it is whole.
void add_level(std::vector<DrawnTrial>& cell, std::vector<DrawnTrial> arrangements, int trials, Sampling sampling,
               RandomStream& stream);

// A track of `trials` trials, in blocks of two of every arrangement, so that the share of each holds everywhere in a session.
std::vector<DrawnTrial> track_of(const std::vector<DrawnTrial>& arrangements, int trials, RandomStream& stream);

// The two orders of a standard and a comparison; the second alone where the standard always comes first.
std::vector<Intervals> orders_of(double standard, double comparison, bool standard_first);

// How often each arrangement came, for sentences: "equally often" or "at random".
std::string_view how_often(const Protocol& protocol);

// Where two values are to be felt side by side on a rig that presents one at a time.
std::vector<TaskProblem> problems_of_places(const Protocol& protocol);

}  // namespace jnd
