// Who took part in a study, of whatever kind, and whose sessions count.
#pragma once

#include <string>
#include <vector>

#include "data/study/study.h"
#include "data/study/study_admin.h"

namespace jnd {

struct SessionHead {
  std::string participant, session, hash;
  SessionKind kind = SessionKind::simulated;
  bool closed = false;
  bool unblinded = false;  // its operator saw forces
};

struct Attendance {
  SessionKind kind = SessionKind::simulated;
  int participants = 0;
  std::vector<SessionHead> heads;             // by participant
  std::vector<ExcludedParticipant> excluded;  // nothing of theirs is in the results
};

// What counts: without the sessions of excluded participants. By participant number, then the participant's session.
std::vector<SessionInfo> sessions_of(const Study& study, SessionKind kind);
// sessions: those of sessions_of.
Attendance attendance_of(const Study& study, SessionKind kind, const std::vector<SessionInfo>& sessions);
// Each once, in the order of the sessions.
std::vector<std::string> participants_of(const std::vector<SessionInfo>& sessions);
// Those of one kind, in the order in which they were excluded.
std::vector<ExcludedParticipant> excluded_of(const Study& study, SessionKind kind);
// The kinds of which something counts, real first.
std::vector<SessionKind> kinds_in(const Study& study);

}  // namespace jnd
