// What was delivered in an interval, computed again from its ticks. Internal to verify_deep.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "data/log/telemetry.h"
#include "protocols/protocol.h"
#include "protocols/vocabulary.h"

namespace jnd {

using TellProblem = std::function<void(const std::string&)>;

// Compares what an event says of one interval with its ticks. Returns how many numbers were compared. cues: of the
// trial's condition.
std::int64_t check_delivery(const Presentation& presentation, const Telemetry& telemetry, const Cues& cues, Unit unit,
                            const TellProblem& problem);
// The same of free interaction, whose pieces have their ticks in one blob.
std::int64_t check_delivery(const std::vector<Presentation>& pieces, const Telemetry& telemetry, Unit unit,
                            const TellProblem& problem);

}  // namespace jnd
