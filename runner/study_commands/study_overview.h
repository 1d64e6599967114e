// How a study is getting on, in what any operator may know: `jnd studies` and `jnd watch`. Nothing here follows from a
// stimulus, a condition or an answer.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "data/study/study.h"

namespace jnd {

struct StudyOverview {
  std::string protocol;                  // its name
  std::string title;                     // of the protocol
  SessionKind kind = SessionKind::real;  // of the sessions that are counted: real, else pilot, else simulated
  int planned = 0;                       // participants, by the protocol
  int finished = 0;                      // of the kind, with all their sessions; without who was excluded
  int left_early = 0;                    // ended for good before the end
  int excluded = 0;
  bool blinded = false;               // real results are in code
  std::vector<SessionInfo> sessions;  // of the kind
  std::optional<bool> in_use{};       // a program writes to it just now; none where nobody looked
  std::optional<int> next_number;     // lowest free number of the plan; none where a newcomer's group decides

  std::vector<SessionInfo> open() const;  // sessions that may be gone on with
  std::string last_session() const;       // when the last one began, ISO 8601 UTC; empty where there is none
};

// Throws InputError where this version cannot read the study's protocol.
StudyOverview overview_of(const Study& study);

// "open, blinded", "complete", "not begun", "in progress".
std::string state_text(const StudyOverview& overview);

// Is it a file that says of itself that it is a study, whole or damaged? Looks at its first bytes, and never throws.
bool claims_to_be_study(const std::filesystem::path& file) noexcept;

}  // namespace jnd
