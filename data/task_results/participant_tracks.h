// The tracks of an adaptive procedure as a participant's answers in a study moved them.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "data/log/session_log.h"
#include "data/study/study.h"
#include "protocols/planning/adaptive_run.h"
#include "protocols/protocol.h"

namespace jnd {

// Of the conditions that the group gets (none: all), by condition and series; tracks of later sessions are numbered on.
// sessions: the events of each, of one participant. Practice, and answers that were taken back, move nothing. Throws
// StorageError where an event contradicts the protocol.
std::vector<AdaptiveTrack> participant_tracks(const std::vector<std::vector<Event>>& sessions, const Protocol& protocol,
                                              const std::string& participant, std::optional<int> group);

// sessions: of one participant, at least one.
std::vector<AdaptiveTrack> participant_tracks(const Study& study, const Protocol& protocol,
                                              std::span<const SessionInfo> sessions);
// The sessions of one participant, from the first of them on. sessions: by participant.
std::span<const SessionInfo> sessions_of_next(std::span<const SessionInfo> sessions) noexcept;

}  // namespace jnd
