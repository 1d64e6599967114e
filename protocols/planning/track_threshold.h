// The threshold that the tracks of an adaptive procedure come to, of one participant in one condition.
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "analysis/thresholds/adaptive_threshold.h"
#include "protocols/planning/adaptive_run.h"
#include "protocols/protocol.h"
#include "protocols/tasks/task.h"

namespace jnd {

// What a threshold rests on: a staircase's last reversals, averaged; QUEST's posterior of the threshold; or the posterior
// of the response model, of all answers of a condition at once. Of protocols with a procedure.
enum class ThresholdSource { reversals, quest, answers };
ThresholdSource threshold_source(const Protocol& protocol) noexcept;

// Of one track, and of all tracks of a participant in a condition, of which those count whose own threshold is ok, and as
// registered (unfinished_tracks) those that did not end.
// protocol: with a procedure, of same-different or with a threshold_source() other than answers.
AdaptiveThreshold track_threshold(const AdaptiveTrack& track, const Protocol& protocol);
AdaptiveThreshold condition_threshold(std::span<const AdaptiveTrack> tracks, const Protocol& protocol);

// Probability of a correct answer (of same-different: of "different") at which the procedure settles: of a staircase its
// target, of QUEST p_threshold. None of the Bayesian procedure, which settles nowhere.
std::optional<double> adaptive_target(const AdaptiveProcedure& procedure);

// Key of the outcome of the tracks.
inline constexpr std::string_view kTrackThreshold = "track_threshold";
// What a study measures: the task's outcomes, and behind them, of a staircase or QUEST, what its tracks come to, where that
// is not the task's own outcome.
std::vector<TaskOutcome> measured_outcomes(const Protocol& protocol);
// Of one participant, condition and series: the task's estimates and that of its tracks, which may be empty.
TaskEstimates measured_estimates(const Protocol& protocol, const Series& series, std::span<const AnsweredTrial> trials,
                                 std::span<const AdaptiveTrack> tracks);

}  // namespace jnd
