// What a session is made of, and how each part of the engine writes to its log.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "data/log/session_log.h"
#include "devices/clock.h"
#include "devices/responder.h"
#include "devices/rig.h"
#include "protocols/planning/plan.h"
#include "protocols/protocol.h"
#include "runner/keys/interrupt.h"
#include "runner/session/record_policy.h"
#include "runner/session/session_view.h"

namespace jnd {

inline constexpr std::int64_t kLook_ns = 20'000'000;  // between two looks at what ends a wait

// All references must outlive the session.
struct SessionParts {
  const Protocol& protocol;
  const Plan& plan;
  Rig& rig;
  Responder& responder;
  SessionLog& log;
  Clock& clock;
  SessionView& view;
  const Interrupts& interrupts;  // what Ctrl-C and signals have asked for
  RecordPolicy record = RecordPolicy::events;
  bool person = false;  // a person feels the stimuli: what was presented is marked before it is answered
  bool sealed = true;   // nobody is told what a rig's programs say: it may name the stimulus
};

// Unwinds a session to its end.
struct SessionEnds {
  bool for_good = false;  // closed as it is; otherwise it can be resumed
  std::string cause;      // "operator", "ctrl-c", "signal", "no consent", ...
  std::string reason;     // the operator's words; may be empty
};

// Writes events, and asks the operator where the log cannot be written just now.
class SessionRecorder {
 public:
  explicit SessionRecorder(const SessionParts& parts) noexcept : parts_(parts) {}

  // Returns when the event is committed. Throws StorageError where the operator gives up, or there is no operator to ask.
  void append(std::string_view kind, const nlohmann::ordered_json& body,
              const std::vector<TelemetryBlob>& telemetry = {}) const;
  // SessionLog::mark, for people only.
  void mark(std::string_view kind, const nlohmann::ordered_json& body) const;
  void note(const std::string& text, int after_trial) const;

 private:
  const SessionParts& parts_;
};

// Does what the operator asks for at any time that is not a trial's: notes, pauses; throws SessionEnds for an end. False:
// the request is the caller's to fulfil (go_on, repeat_trial, void_last, end_block, take_break).
bool fulfilled(const SessionParts& parts, const SessionRecorder& recorder, int after_trial,
               const OperatorRequest& request);

// Asks the operator until a request is the caller's. Between two askings stops and signals are handled. ask: gives the
// operator's request.
template <typename Ask>
OperatorRequest settle(const SessionParts& parts, const SessionRecorder& recorder, int after_trial, Ask&& ask);

// Devices neutral, until the operator goes on or stops them. cause: "key", "ctrl-c". Throws SessionEnds where the
// session ends.
void pause_session(const SessionParts& parts, const SessionRecorder& recorder, const std::string& cause,
                   const std::string& reason, int after_trial);

// Pauses where Ctrl-C was pressed, ends where a signal or a second Ctrl-C asks for it, and where the rig's stop is
// latched waits for the person who clears it. Call between steps.
void handle_interrupts(const SessionParts& parts, const SessionRecorder& recorder, int after_trial);

// The rig's stop is latched: only a person's word clears it. Throws SessionEnds where the session ends instead.
void recover_from_stop(const SessionParts& parts, const SessionRecorder& recorder, const std::string& stopped_by,
                       int after_trial);

// Waits for a time of the session's clock, with an eye on what cannot wait: a stop and signals, and where the operator
// is heard SessionView::waiting, or gap within a trial. False: one of them came first.
enum class OperatorHeard { no, between_trials, in_gap };
bool wait_until(const SessionParts& parts, std::int64_t deadline_ns, OperatorHeard heard = OperatorHeard::no);
// The whole of it: what came first is handled, and the rest is waited for. Without a person a stop ends it.
void wait_out(const SessionParts& parts, const SessionRecorder& recorder, std::int64_t deadline_ns, int after_trial);

template <typename Ask>
OperatorRequest settle(const SessionParts& parts, const SessionRecorder& recorder, int after_trial, Ask&& ask) {
  for (;;) {
    handle_interrupts(parts, recorder, after_trial);
    OperatorRequest request = ask();
    if (!fulfilled(parts, recorder, after_trial, request)) return request;
  }
}

}  // namespace jnd
