// Simulates the studies of a power question, on several threads.
#pragma once

#include <cstdint>
#include <functional>

#include "protocols/protocol.h"
#include "runner/power/power_question.h"
#include "runner/power/power_tally.h"

namespace jnd {

// Which studies: first to last - 1, of 0 to PowerQuestion::studies - 1.
struct StudyRange {
  std::int64_t first = 0, last = 0;
};
// Shard `number` of `of`, from 1, of all studies: they differ by one study at most.
StudyRange shard_range(std::int64_t studies, int number, int of) noexcept;

// The tally of these studies: the same on any number of threads. progress: called by one thread at a time with the
// number of studies that are done. Throws Stopped (analysis/numerics/stop_request.h).
PowerTally power_study(const Protocol& protocol, const PowerQuestion& question, StudyRange range, int threads,
                       const std::function<void(std::int64_t)>& progress = {});

}  // namespace jnd
