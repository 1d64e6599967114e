// What is said about a study outside its sessions: who is left out, that results were looked at, notes. Each is an
// event in the study's own chain, with its reason; nothing is ever changed or taken away.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "data/study/study.h"

namespace jnd {

// Leaves a participant out of every analysis. replace: the number of the plan is free again, for another
// participant. Throws StorageError: no session of that kind has that code, it is excluded already, or there is no reason.
void exclude_participant(Study& study, const std::string& participant, SessionKind kind, const std::string& reason,
                         bool replace, Stamp stamp);

// From now on results of people are shown as they are. Throws StorageError without a reason, or where it was done
// before.
void unblind(Study& study, const std::string& reason, Stamp stamp);
bool is_unblinded(const Study& study);

// About the study, or about a participant of any kind. Throws StorageError: an empty text, no session of that code.
void add_note(Study& study, const std::string& text, Stamp stamp,
              const std::optional<std::string>& participant = std::nullopt);

// The lowest number of the plan that no session of that kind has, counting those of replaced participants as free.
// first, step: of the numbers that may be taken, where not every one may: 2, 5, 8, ...
int next_participant_number(const std::vector<SessionInfo>& sessions, SessionKind kind, int first = 1, int step = 1);

struct ExcludedParticipant {
  std::string participant;
  SessionKind kind = SessionKind::real;
  std::string reason;
  bool replace = false;
  std::string utc;  // ISO 8601
};
// In the order in which they were excluded.
std::vector<ExcludedParticipant> excluded_from(const Study& study);

}  // namespace jnd
