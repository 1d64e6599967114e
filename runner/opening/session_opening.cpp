#include "runner/opening/session_opening.h"

#include <algorithm>
#include <cctype>
#include <vector>

#include <boost/uuid/random_generator.hpp>
#include <boost/uuid/uuid_io.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "data/log/event_body.h"
#include "data/log/replay.h"
#include "data/study/study_admin.h"
#include "protocols/input/look_alikes.h"
#include "protocols/planning/allotment.h"
#include "runner/session/simulate.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/terminal.h"

namespace jnd {

namespace {

constexpr std::size_t kLongestCode = 32;

void refuse_excluded(const std::vector<SessionInfo>& sessions, const SessionRequest& request) {
  for (const SessionInfo& session : sessions)
    if (session.participant == request.participant && session.kind == request.kind && session.excluded)
      throw UsageError(fmt::format("participant {} was excluded from this study; a newcomer needs a code of their own",
                                   request.participant));
}

// On many disks the folders of their results would be one, and who reads a list takes them for one person.
void refuse_look_alikes(const std::vector<SessionInfo>& sessions, const SessionRequest& request) {
  const auto begun = [&](const SessionInfo& one) { return one.participant == request.participant; };
  if (std::any_of(sessions.begin(), sessions.end(), begun)) return;
  for (const SessionInfo& session : sessions)
    if (look_of(session.participant) == look_of(request.participant))
      throw UsageError(fmt::format(
          "participant {}: the study has a participant {}, and codes that differ in capitals or zeros only are mistaken "
          "for each other. For the same person: --participant {}; a newcomer needs another code",
          request.participant, session.participant, session.participant));
}

// A mistyped code would begin a second participant while the first one waits with the device on.
void refuse_while_another_waits(const std::vector<SessionInfo>& sessions, const SessionRequest& request) {
  if (request.beside || request.kind == SessionKind::simulated) return;
  for (const SessionInfo& session : sessions)
    if (session.kind == request.kind && session.state == "open" && !session.excluded &&
        session.participant != request.participant)
      throw UsageError(fmt::format(
          "participant {}'s session is unfinished ({} of {} trials). To go on with it: --participant {}. To "
          "begin {} while it waits: add --new. To give it up: jnd exclude, or go on with it and end it for "
          "good",
          session.participant, session.trials_done, session.trials_total, session.participant, request.participant));
}

// Of a participant whose number is known: the group belongs to it.
std::string group_of_number(const Study& study, const Protocol& protocol, const SessionRequest& request, int number) {
  std::string group(group_name(protocol, group_of(protocol, number, study.info().seed)));
  if (!request.group.empty() && request.group != group)
    throw UsageError(fmt::format(
        "participant {} is of group {}, not {}: leave --group out, or look whether the code is right; a "
        "participant who began in a wrong group is excluded (jnd exclude --replace) and begins anew with another code",
        request.participant, group, printable(request.group)));
  return group;
}

SessionTarget resumed_target(const Study& study, const Protocol& protocol, const SessionRequest& request,
                             const SessionInfo& session) {
  if (session.responder != request.responder)
    throw UsageError(fmt::format("participant {}'s session was begun with {}, not {}; go on with that",
                                 session.participant, printable(session.responder), printable(request.responder)));
  SessionTarget target;
  target.participant_number = session.participant_number;
  target.group = group_of_number(study, protocol, request, session.participant_number);
  target.number = session.number;
  target.resumed = session;
  target.state = replay(study.events(session.id));
  target.check = check_resume(target.state, protocol.resume, request.now);
  if (request.responder != "keyboard") target.check.practice_again = target.check.redo_block = false;  // no person
  target.language = request.language.value_or(session.language);
  if (request.kind != SessionKind::simulated && target.check.too_long && request.accept_gap.empty())
    throw UsageError(fmt::format(
        "participant {}: {}the interruption is longer than the protocol allows. Where there is a good reason "
        "to go on all the same: --accept-gap \"REASON\" (it is kept). Otherwise give the session up: jnd "
        "exclude",
        session.participant, resume_text(target.check, protocol.resume)));
  return target;
}

}  // namespace

void check_participant_code(const std::string& code) {
  const bool plain =
      std::all_of(code.begin(), code.end(), [](unsigned char c) { return std::isalnum(c) != 0 && c < 0x80; });
  if (code.empty() || code.size() > kLongestCode || !plain)
    throw UsageError(fmt::format("'{}' is not a participant code: 1 to {} letters and digits, such as P01",
                                 printable(code), kLongestCode));
}

void check_group(const Protocol& protocol, const std::string& group, bool newcomer) {
  const std::string names = fmt::format("{}", fmt::join(group_names(protocol), ", "));
  if (!group.empty()) {
    if (protocol.groups.empty()) throw UsageError("--group: the protocol has no groups of participants; leave it out");
    if (!group_named(protocol, group))
      throw UsageError(fmt::format("--group {}: the protocol has the groups {}", printable(group), names));
    if (protocol.allotment == Allotment::balanced)
      throw UsageError("--group: this study allots its participants itself, by their numbers; leave it out");
  } else if (newcomer && operator_says_group(protocol)) {
    throw UsageError(fmt::format("say the participant's group: --group NAME, with one of {}", names));
  }
}

SessionTarget choose_session(const Study& study, const Protocol& protocol, const SessionRequest& request) {
  const std::vector<SessionInfo> sessions = study.sessions();
  refuse_excluded(sessions, request);
  refuse_look_alikes(sessions, request);
  SessionTarget target;
  std::string last_ended;
  int finished = 0;
  for (const SessionInfo& session : sessions) {
    if (session.participant != request.participant || session.kind != request.kind) continue;
    if (session.state != "closed") return resumed_target(study, protocol, request, session);
    target.participant_number = session.participant_number;
    last_ended = std::max(last_ended, session.ended);
    ++finished;
  }
  if (finished >= protocol.design.sessions)
    throw UsageError(fmt::format("participant {} has finished this study ({} session, {}); use another code",
                                 request.participant, to_string(request.kind), last_ended));
  refuse_while_another_waits(sessions, request);
  target.number = finished + 1;
  if (finished == 0) {
    check_group(protocol, request.group, true);
    const std::optional<int> group = group_named(protocol, request.group);
    target.participant_number =
        next_participant_number(sessions, request.kind, group ? *group + 1 : 1, group ? group_count(protocol) : 1);
  }
  target.group = group_of_number(study, protocol, request, target.participant_number);
  target.language = request.language.value_or("");
  return target;
}

void check_same_rig(const SessionTarget& target, const RigInfo& rig) {
  if (!target.resumed) return;
  const std::string& before = target.resumed->rig_sha256;
  if (before.empty() || rig.sha256.empty() || before == rig.sha256) return;
  throw UsageError(
      fmt::format("this session was begun with another rig (description {}..., now {}...): put the device's "
                  "description back as it was, or give the session up (jnd exclude --replace) and begin it anew",
                  before.substr(0, 12), rig.sha256.substr(0, 12)));
}

OpenedSession open_session(Study& study, const SessionRequest& request, const SessionTarget& target, const Plan& plan,
                           const RigInfo& rig, Stamp stamp) {
  OpenedSession opened;
  if (target.resumed) {
    opened.id = target.resumed->id;
    opened.log = study.resume_session(opened.id);
    opened.log->append(event_kind::kSessionResumed,
                       resumed_body(target.check, request.now, target.resumed->trials_done, request.accept_gap), stamp);
    return opened;
  }
  NewSession session;
  session.participant = request.participant;
  session.kind = request.kind;
  session.participant_number = target.participant_number;
  session.number = target.number;
  session.id = request.kind == SessionKind::simulated
                   ? simulated_session_id(study.info(), target.participant_number, target.number)
                   : to_string(boost::uuids::random_generator()());
  session.responder = request.responder;
  session.profile_sha256 = request.profile_sha256;
  session.language = target.language;
  session.group = target.group;
  session.boot_id = request.now.boot_id;
  session.rig = rig.name;
  session.rig_mode = rig.mode;
  session.tracker = rig.tracker;
  session.rig_sha256 = rig.sha256;
  session.trials_total = std::max(main_trial_count(plan), static_cast<int>(plan.explorations.size()));
  session.stamp = stamp;
  opened.id = session.id;
  opened.log = study.open_session(session);
  return opened;
}

}  // namespace jnd
