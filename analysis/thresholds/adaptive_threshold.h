// Thresholds of adaptive tracks: the mean of a staircase's reversals, the posterior of QUEST, and that of a response model.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "analysis/numerics/special_values.h"

namespace jnd {

// Mean and standard deviation (n - 1) of the last `at_most` reversals, an even number of them so that peaks and valleys
// weigh alike (Levitt 1971, "Transformed up-down methods in psychoacoustics", J. Acoust. Soc. Am. 49, 467-477). n is 0,
// mean and sd are NaN with fewer than two reversals.
struct ReversalMean {
  int n = 0;
  double mean = 0, sd = 0;
};
ReversalMean mean_of_reversals(const std::vector<double>& reversals, int at_most);

enum class AdaptiveStatus {
  ok,
  too_few_reversals,  // of a staircase: fewer than are to be averaged; a mean of fewer is given all the same
  no_trials,          // no trial with a difference was answered
  pinned_at_clamp,    // the levels end at an end of the clamp: the threshold lies there or beyond
  too_few_answers,    // of a response model's posterior: the prior still says more than the answers
  pinned_at_grid      // of the same: no JND is likelier than one at an end of the grid
};

// The tracks behind the threshold of a condition.
struct TrackCount {
  int all = 0, used = 0;
  int unfinished = 0;  // staircases with too_few_reversals
};

// What becomes of a staircase's track with too_few_reversals: left out, or used with those that it has, if at least 2.
enum class UnfinishedTracks { leave_out, use };

struct AdaptiveThreshold {
  AdaptiveStatus status = AdaptiveStatus::no_trials;
  // In the unit of the levels; NaN where there is none.
  double threshold = 0;
  // Of a staircase the standard deviation of the averaged reversals, in the unit of the levels; of QUEST that of the
  // posterior, of log10 of the level; of a response model that of ln JND.
  double sd = 0;
  int n = 0;  // reversals averaged; of a posterior the trials that it rests on
  // Of a response model: the middle 95 % of the posterior, in the unit of the levels.
  double low = kNaN, high = kNaN;
  double prior_weight = 0;  // of a posterior: its variance over that of the prior; 0 without a prior
  TrackCount tracks{};      // of several tracks of staircases or QUEST
};

// levels: presented, in order; clamp: lowest and highest level. A staircase is pinned where more than half of its
// averaged reversals, or without any its last level, stand at one end of the clamp.
AdaptiveThreshold staircase_threshold(const std::vector<double>& levels, const std::vector<double>& reversals,
                                      int averaged, const std::array<double, 2>& clamp);

// mean, sd: of the posterior of log10 of the level. Pinned where the mean is at or beyond an end of the clamp.
AdaptiveThreshold quest_threshold(double mean, double sd, int trials, const std::array<double, 2>& clamp);

// Of ln s of a response model (analysis/procedures/posterior.h), given all answers.
struct LogPosterior {
  double mean = 0, sd = 0;
  double low = 0, high = 0;  // its 2.5 and 97.5 % points
  double prior_sd = 0;       // before any answer
  bool at_end = false;       // it is highest at an end of the grid
  int trials = 0;
};
// The JND s, exp of the mean. There is none while the variance is above half of the prior's, so that the answers say less
// than the prior, nor where the posterior is highest at an end of the grid; sd and n are given all the same.
AdaptiveThreshold posterior_threshold(const LogPosterior& posterior);

// Several tracks of one participant and condition. Those that are ok (or unfinished, if these are used) are averaged:
// levels of staircases, logarithms of QUEST, whose standard deviation is that of the mean of independent posteriors. n
// adds up; a staircase's sd is pooled over the tracks. Without one that is ok the status is the tracks' worst.
AdaptiveThreshold combined_staircases(const std::vector<AdaptiveThreshold>& tracks,
                                      UnfinishedTracks unfinished = UnfinishedTracks::leave_out);
AdaptiveThreshold combined_quests(const std::vector<AdaptiveThreshold>& tracks);

std::string_view to_string(AdaptiveStatus status) noexcept;

}  // namespace jnd
