// Which session `jnd run` runs: a new one, or one that was interrupted; and everything that must be refused before
// a device is put on, with what to do instead.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "data/study/study.h"
#include "devices/rig.h"
#include "protocols/planning/plan.h"
#include "protocols/protocol.h"
#include "runner/opening/resume_check.h"

namespace jnd {

struct SessionRequest {
  std::string participant;  // code
  SessionKind kind = SessionKind::pilot;
  std::string responder;       // "keyboard", "profile NAME"
  std::string profile_sha256;  // empty for people
  bool beside = false;         // another participant's session may stay unfinished
  std::string accept_gap;  // why an interruption that is longer than the protocol allows does not matter; may be empty
  std::optional<std::string> language;
  std::string group;  // of the participant, as the operator says it; may be empty
  ResumeMoment now;
};

// What will be run. Nothing is written yet.
struct SessionTarget {
  int participant_number = 0;
  int number = 1;                      // which of the participant's sessions
  std::optional<SessionInfo> resumed;  // none: a new session
  SessionState state;                  // of the one that is resumed
  ResumeCheck check;                   // of the one that is resumed
  std::string language;                // of the participant's texts
  std::string group;                   // of the participant; empty where the protocol has no groups
};

// 1 to 32 letters and digits. Throws UsageError.
void check_participant_code(const std::string& code);

// Throws UsageError where the group that the operator says is none of the protocol's, or is not theirs to say; of a
// newcomer also where it is missing.
void check_group(const Protocol& protocol, const std::string& group, bool newcomer);

// Throws UsageError where the session must not be run: finished, excluded, another's unfinished, another responder, another
// group, a gap that is too long without a reason.
SessionTarget choose_session(const Study& study, const Protocol& protocol, const SessionRequest& request);

// Throws UsageError where the session that is to go on was begun with another rig.
void check_same_rig(const SessionTarget& target, const RigInfo& rig);

struct OpenedSession {
  std::string id;
  std::unique_ptr<SessionLog> log;
};
// Writes session.opened or session.resumed.
OpenedSession open_session(Study& study, const SessionRequest& request, const SessionTarget& target, const Plan& plan,
                           const RigInfo& rig, Stamp stamp);

}  // namespace jnd
