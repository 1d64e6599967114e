// The board of `jnd watch`: how a study and its open session are getting on, for the supervisor next door.
#pragma once

#include <cstdint>
#include <string>

#include "runner/study_commands/study_overview.h"

namespace jnd {

// Lines of text, each ended by a line feed, at most `rows` of them where rows > 0: then the oldest sessions are left out.
// It tells nothing that `jnd status` does not. now_utc_ns: of the clock that sessions began by.
std::string board_text(const StudyOverview& overview, const std::string& study, std::int64_t now_utc_ns, int rows);

}  // namespace jnd
