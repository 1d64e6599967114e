// The arrangements of a level, such as standard first and comparison first, each equally often.
#pragma once

#include <vector>

#include "protocols/random_stream.h"
#include "protocols/tasks/task.h"

namespace jnd {

// Adds `trials` of the level: balanced, every arrangement equally often and the rest of the division drawn without
// repetition; random, each trial one of them at random. In no order: shuffle the cell when it is whole.
void add_level(std::vector<DrawnTrial>& cell, std::vector<DrawnTrial> arrangements, int trials, Sampling sampling,
               RandomStream& stream);

// The two orders of a standard and a comparison; the second alone where the standard always comes first.
std::vector<Intervals> orders_of(double standard, double comparison, bool standard_first);

// Where two values are to be felt side by side on a rig that presents one at a time.
std::vector<TaskProblem> problems_of_places(const Protocol& protocol);

}  // namespace jnd
