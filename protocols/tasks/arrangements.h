// The arrangements of a level, such as standard first and comparison first, each equally often; those of an adaptive
// track.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "protocols/protocol.h"
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

// Which trials of an adaptive track have equal stimuli, and in which order the two stimuli of the others come.

// A share of catch trials is kept in blocks of so many trials: short, so that it holds everywhere in a session, but
// long enough that the last trial of a block is hard to foresee.
struct CatchBlock {
  int trials = 0;   // the least multiple of the share's denominator that is long enough
  int catches = 0;  // of these
};
// None where the share is not a fraction with a denominator of at most 20. shortest: trials of the shortest block.
std::optional<CatchBlock> catch_block(double share, int shortest = 8);
// The block of a procedure: of the Bayesian one 6 trials or more, as its two kinds of trials have in its definition.
std::optional<CatchBlock> catch_block_of(const AdaptiveProcedure& procedure);

// How many trials a track has with `different` trials that have a difference.
int slots_of_track(const CatchBlock& block, int different);

// Trials of all tracks of a procedure, catch trials among them; 0 where its share cannot be kept.
int trials_with_catches(const AdaptiveProcedure& procedure);

// The slots of one track. In every block the reference comes first in half of the trials with a difference, and half of
// the catch trials present the reference twice, the others the comparison; where a half is not whole, a coin decides. A
// comparison is set_by_answers(reference). The last block may be a part with the same share, rounded.
std::vector<std::array<double, 2>> draw_slots(const CatchBlock& block, int different, double reference,
                                              RandomStream& stream);

}  // namespace jnd
