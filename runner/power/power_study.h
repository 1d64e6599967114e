// Simulates the studies of a power question, on several threads.
#pragma once

#include <cstdint>
#include <functional>

#include "protocols/protocol.h"
#include "runner/power/power_question.h"
#include "runner/power/power_tally.h"
#include "runner/shards/study_shard.h"

namespace jnd {

// The tally of these studies: the same on any number of threads. progress: called by one thread at a time with the
// number of studies that are done. Throws Stopped (analysis/numerics/stop_request.h).
PowerTally power_study(const Protocol& protocol, const PowerQuestion& question, StudyRange range, int threads,
                       const std::function<void(std::int64_t)>& progress = {});

}  // namespace jnd
