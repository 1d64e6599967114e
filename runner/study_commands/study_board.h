// The board of `jnd watch`: how a study and its open session are getting on, for the supervisor next door.
#pragma once

#include <cstdint>
#include <string>

#include "runner/study_commands/study_overview.h"

namespace jnd {

// Lines of text, each ended by a line feed. rows > 0: so many lines of a screen of these columns (0: without end), for
// which the oldest sessions are left out; what stands above them is always there.
// It tells nothing of what was felt and answered that `jnd status` does not. now_utc_ns: of the clock that sessions began by.
std::string board_text(const StudyOverview& overview, const std::string& study, std::int64_t now_utc_ns, int rows,
                       std::size_t columns);

}  // namespace jnd
