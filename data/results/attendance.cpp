#include "data/results/attendance.h"

#include <algorithm>

namespace jnd {

std::vector<SessionInfo> sessions_of(const Study& study, SessionKind kind) {
  std::vector<SessionInfo> sessions = study.sessions();  // by participant number
  std::erase_if(sessions, [&](const SessionInfo& session) { return session.kind != kind || session.excluded; });
  return sessions;
}

std::vector<std::string> participants_of(const std::vector<SessionInfo>& sessions) {
  std::vector<std::string> participants;
  for (const SessionInfo& session : sessions)
    if (participants.empty() || participants.back() != session.participant) participants.push_back(session.participant);
  return participants;
}

std::vector<ExcludedParticipant> excluded_of(const Study& study, SessionKind kind) {
  std::vector<ExcludedParticipant> excluded = excluded_from(study);
  std::erase_if(excluded, [&](const ExcludedParticipant& one) { return one.kind != kind; });
  return excluded;
}

Attendance attendance_of(const Study& study, SessionKind kind, const std::vector<SessionInfo>& sessions) {
  Attendance attendance{kind, static_cast<int>(participants_of(sessions).size()), {}, excluded_of(study, kind)};
  for (const SessionInfo& session : sessions)
    attendance.heads.push_back(
        {session.participant, session.id, session.head, kind, session.state == "closed", session.unblinded});
  return attendance;
}

std::vector<SessionKind> kinds_in(const Study& study) {
  std::vector<SessionKind> kinds;
  for (const SessionInfo& session : study.sessions())
    if (!session.excluded && (kinds.empty() || kinds.back() != session.kind)) kinds.push_back(session.kind);
  return kinds;
}

}  // namespace jnd
