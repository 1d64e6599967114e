// What a session is made of, and how each part of the engine writes to its log.
#pragma once

#include <atomic>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "data/session_log.h"
#include "devices/clock.h"
#include "devices/responder.h"
#include "devices/rig.h"
#include "protocols/plan.h"
#include "protocols/protocol.h"
#include "runner/interrupt.h"
#include "runner/record_policy.h"
#include "runner/session_view.h"

namespace jnd {

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
  bool person = false;  // somebody feels the stimuli: what was presented is marked before it is answered
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

  // Returns when the event is committed. Throws StorageError where the operator gives up, or there is nobody to ask.
  void append(std::string_view kind, const nlohmann::ordered_json& body,
              const std::vector<TelemetryBlob>& telemetry = {}) const;
  // SessionLog::mark, for people only.
  void mark(std::string_view kind, const nlohmann::ordered_json& body) const;
  void note(const std::string& text, int after_trial) const;

 private:
  const SessionParts& parts_;
};

// Does what the operator wishes at any time that is not a trial's: notes, pauses; throws SessionEnds for an end.
// Returns the first wish that is the caller's to fulfil (go_on, repeat_trial, void_last, end_block, take_break). again:
// asks the operator anew after a note or a pause.
template <typename Ask>
OperatorWish settle(const SessionParts& parts, const SessionRecorder& recorder, int after_trial, Ask&& again);

// Devices neutral, until the operator goes on. cause: "key", "ctrl-c". Throws SessionEnds where the session ends.
void pause_session(const SessionParts& parts, const SessionRecorder& recorder, const std::string& cause,
                   const std::string& reason, int after_trial);

// Pauses where Ctrl-C was pressed, ends where a signal or a second Ctrl-C asks for it. Call between steps.
void heed_interrupts(const SessionParts& parts, const SessionRecorder& recorder, int after_trial);

// The rig's stop is latched: only a person's word clears it. Throws SessionEnds where the session ends instead.
void recover_from_stop(const SessionParts& parts, const SessionRecorder& recorder, const std::string& stopped_by,
                       int after_trial);

template <typename Ask>
OperatorWish settle(const SessionParts& parts, const SessionRecorder& recorder, int after_trial, Ask&& again) {
  for (;;) {
    heed_interrupts(parts, recorder, after_trial);
    OperatorWish wish = again();
    switch (wish.wish) {
      case Wish::note:
        recorder.note(wish.text, after_trial);
        break;
      case Wish::pause:
        if (parts.interrupts.pause) break;  // Ctrl-C: it is heeded above, and its stop of the rig is taken back
        pause_session(parts, recorder, "key", wish.text, after_trial);
        break;
      case Wish::end_for_now:
        throw SessionEnds{false, "operator", wish.text};
      case Wish::end_for_good:
        throw SessionEnds{true, "operator", wish.text};
      default:
        return wish;
    }
  }
}

}  // namespace jnd
