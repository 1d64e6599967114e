// jnd run: a session from this terminal. On simulated devices it is a rehearsal: kind pilot with a person at the keys,
// kind simulated where a profile answers.
#include <algorithm>
#include <cctype>

#include <boost/uuid/random_generator.hpp>
#include <boost/uuid/uuid_io.hpp>
#include <fmt/format.h>

#include "data/event_body.h"
#include "devices/rig_factory.h"
#include "protocols/plan.h"
#include "runner/commands.h"
#include "runner/console.h"
#include "runner/fast_clock.h"
#include "runner/interrupt.h"
#include "runner/resources.h"
#include "runner/session_engine.h"
#include "runner/simulate.h"
#include "runner/study_access.h"
#include "runner/terminal.h"

namespace jnd {

namespace {

constexpr std::size_t kLongestCode = 32;

std::string ask_participant(Keyboard& keyboard) {
  fmt::print("Participant code (letters and digits): ");
  std::fflush(stdout);
  return keyboard.line().value_or("");
}

void check_code(const std::string& code) {
  const bool plain =
      std::all_of(code.begin(), code.end(), [](unsigned char c) { return std::isalnum(c) != 0 && c < 0x80; });
  if (code.empty() || code.size() > kLongestCode || !plain)
    throw UsageError(fmt::format("'{}' is not a participant code: 1 to {} letters and digits, such as P01",
                                 printable(code), kLongestCode));
}

int lowest_free_number(const std::vector<SessionInfo>& sessions, SessionKind kind) {
  int number = 1;
  const auto taken = [&](int candidate) {
    return std::any_of(sessions.begin(), sessions.end(),
                       [&](const SessionInfo& s) { return s.kind == kind && s.participant_number == candidate; });
  };
  while (taken(number)) ++number;
  return number;
}

// The session to run: the participant's open one, or a new one.
struct Opened {
  SessionInfo info;
  std::unique_ptr<SessionLog> log;
  bool resumed = false;
};

Opened open_or_resume(Study& study, const Protocol& protocol, const std::string& code, SessionKind kind,
                      const std::string& responder, const std::string& profile_sha256, const RigInfo& rig,
                      Clock& clock) {
  const std::vector<SessionInfo> sessions = study.sessions();
  for (const SessionInfo& session : sessions) {
    if (session.participant != code || session.kind != kind) continue;
    if (session.state == "closed")
      throw UsageError(fmt::format("participant {} has finished this study ({} session, {}); use another code", code,
                                   to_string(kind), session.ended));
    if (session.responder != responder)
      throw UsageError(fmt::format("participant {}'s session was begun with {}, not {}; go on with that", code,
                                   session.responder, responder));
    Opened opened{session, study.resume_session(session.id), true};
    const SessionState state = replay(opened.log->events());
    const double gap_s = static_cast<double>(clock.utc_ns() - state.last_utc_ns) * 1e-9;
    opened.log->append(event_kind::kSessionResumed, {{"gap_s", gap_s}, {"trials_done", session.trials_done}},
                       {clock.utc_ns(), clock.now_ns()});
    return opened;
  }
  NewSession session;
  session.participant = code;
  session.kind = kind;
  session.participant_number = lowest_free_number(sessions, kind);
  session.id = kind == SessionKind::simulated ? simulated_session_id(study.info().seed, session.participant_number)
                                              : to_string(boost::uuids::random_generator()());
  session.responder = responder;
  session.profile_sha256 = profile_sha256;
  session.rig = rig.name;
  session.rig_mode = rig.mode;
  session.tracker = rig.tracker;
  session.rig_sha256 = rig.sha256;
  const Plan plan = make_plan(protocol, session.participant_number, study.info().seed);
  session.trials_total = main_trial_count(plan);
  session.stamp = {clock.utc_ns(), clock.now_ns()};
  Opened opened;
  opened.log = study.open_session(session);
  for (const SessionInfo& info : study.sessions())
    if (info.id == session.id) opened.info = info;
  return opened;
}

void note_realtime(SessionLog& log, const RealtimeReport& report, const Clock& clock) {
  nlohmann::ordered_json items = nlohmann::ordered_json::array();
  for (const RealtimeItem& item : report.items)
    items.push_back({{"what", item.what}, {"ok", item.ok}, {"detail", item.detail}, {"why_not", item.why_not}});
  log.append(event_kind::kRealtime, {{"policy", to_string(report.policy)}, {"items", std::move(items)}},
             {clock.utc_ns(), clock.now_ns()});
  const std::string problems = report.problems();
  if (!problems.empty()) fmt::print("{}\n{}\n", warn("The loop is not real-time:"), problems);
}

void greet(const Protocol& protocol, const Opened& opened, SessionKind kind, bool fast) {
  const std::string what = kind == SessionKind::pilot
                               ? "REHEARSAL on simulated devices (kind pilot: never counted as real data)"
                               : "DEMONSTRATION with a simulated participant (kind simulated)";
  fmt::print("{}\n{}\n", bold(printable(protocol.title)), warn(what));
  fmt::print("participant {}, {} of {} trials done{}{}\n", opened.info.participant, opened.info.trials_done,
             opened.info.trials_total, opened.resumed ? "; going on with the session" : "",
             fast ? "; waiting takes no time (--fast)" : "");
}

}  // namespace

int command_run(const RunOptions& options) {
  const Protocol protocol = load_checked_protocol(options.protocol);
  const RigDescription description = rig_of(protocol);
  const bool person = !options.responder;
  const ParticipantProfile profile =
      load_profile(find_resource(Resource::profile, options.responder.value_or(default_profile(protocol))));
  const RecordPolicy record = record_policy_of(options.record);
  const SessionKind kind = person ? SessionKind::pilot : SessionKind::simulated;

  std::unique_ptr<Keyboard> keyboard;
  if (person) keyboard = std::make_unique<Keyboard>();
  const std::string code = !options.participant.empty() ? options.participant
                           : person                     ? ask_participant(*keyboard)
                                                        : participant_code(1);
  check_code(code);

  std::unique_ptr<Clock> clock;
  if (options.fast)
    clock = std::make_unique<FastClock>();
  else
    clock = std::make_unique<SteadyClock>();
  const std::unique_ptr<Study> study =
      open_or_create_study(options.study, protocol, options.seed, {clock->utc_ns(), clock->now_ns()});
  const std::uint64_t seed = study->info().seed;
  const Opened opened =
      open_or_resume(*study, protocol, code, kind, person ? "keyboard" : "profile " + profile.name,
                     person ? "" : profile.sha256, simulated_rig_info(protocol, description.spec), *clock);
  const Plan plan = make_plan(protocol, opened.info.participant_number, seed);
  SimulatedClock device_clock(clock->utc_ns());
  RigOptions how = rig_options(record, protocol, description);
  // On the real clock the loop has a thread of its own; in a quick rehearsal it runs inside the session's.
  if (!options.fast) how.realtime = realtime_policy_of(options.realtime);
  std::unique_ptr<Rig> rig = make_simulated_rig(protocol, description, profile, plan.participant, seed,
                                                options.fast ? static_cast<Clock&>(device_clock) : *clock, how);
  if (options.fast) rig = std::make_unique<FastRig>(std::move(rig), device_clock, *clock);
  const StopOnInterrupt stop_rig(rig->stop);
  const StopOnKey stop_key(keyboard.get(), rig->stop);
  if (how.realtime) note_realtime(*opened.log, rig->realtime(), *clock);
  std::unique_ptr<Responder> responder;
  if (person)
    responder = std::make_unique<KeyboardResponder>(
        protocol, *keyboard, *clock, options.participant_presses ? EnteredBy::participant : EnteredBy::operator_);
  else
    responder = make_simulated_participant(profile, protocol, plan.participant, seed, *clock);

  greet(protocol, opened, kind, options.fast);
  ConsoleView view(keyboard.get(), *clock);
  SessionEngine engine(protocol, plan, *rig, *responder, *opened.log, *clock, view, interrupt_requested(), record);
  const SessionEnd end = engine.run(replay(opened.log->events()));
  if (end == SessionEnd::interrupted) {
    study->close();
    fmt::print("\nStopped. Every answer so far is saved in {}; the same command goes on at the next trial.\n",
               options.study);
    return exit_code::kInterrupted;
  }
  study->close_session(opened.info.id, {clock->utc_ns(), clock->now_ns()});
  study->close();
  fmt::print("\n{} The session of {} is complete and saved in {}.\n", bold("Done."), code, options.study);
  return exit_code::kDone;
}

}  // namespace jnd
