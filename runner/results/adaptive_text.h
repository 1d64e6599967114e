// The thresholds of an adaptive study, as a person reads them and as JSON.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "data/results/adaptive_results.h"

namespace jnd {

// A table of the conditions, one of the participants, and what the numbers rest on. tracks: with a line for each track.
std::string to_text(const AdaptiveResults& results, const Protocol& protocol, bool tracks = false);

// {kind, procedure: {kind, target, clamp, catch_share}, group: [...], rows: [...]}: rows with participant, condition,
// track (null: all of them), counts, threshold, sd, n, weber, status; tracks with their levels and reversals.
nlohmann::ordered_json to_json(const AdaptiveResults& results, const Protocol& protocol);

}  // namespace jnd
