// The threshold that the tracks of an adaptive procedure come to, of one participant in one condition.
#pragma once

#include <span>

#include "analysis/thresholds/adaptive_threshold.h"
#include "protocols/planning/adaptive_run.h"
#include "protocols/protocol.h"

namespace jnd {

// What a threshold rests on: a staircase's last reversals, averaged; QUEST's posterior of the threshold; or the posterior
// of the response model, of all answers of a condition at once. Of protocols with a procedure.
enum class ThresholdSource { reversals, quest, answers };
ThresholdSource threshold_source(const Protocol& protocol) noexcept;

// protocol: same-different with a procedure. Of one track, and of all tracks of a participant in a condition, of which
// those count whose own threshold is ok.
AdaptiveThreshold track_threshold(const AdaptiveTrack& track, const Protocol& protocol);
AdaptiveThreshold condition_threshold(std::span<const AdaptiveTrack> tracks, const Protocol& protocol);

}  // namespace jnd
