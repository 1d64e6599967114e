// What the engine tells the person at the terminal, and what it asks of them. It never tells a stimulus, nor a
// condition's real name.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "protocols/delivery.h"
#include "protocols/protocol.h"
#include "protocols/vocabulary.h"

namespace jnd {

// What the operator asks for between and within trials. Each is logged with its reason.
enum class Request {
  go_on,
  pause,         // devices neutral, clock of the session stopped until the operator goes on
  repeat_trial,  // this attempt is voided and comes again at the end of its block
  void_last,     // the last answer is taken back: its trial comes again at the end of its block
  note,          // a text for the log
  end_block,     // the rest of the block is given up
  take_break,    // a break that the protocol does not ask for
  end_for_now,   // resumable
  end_for_good,  // the session is closed as it is
  stopped        // nothing; the rig's stop came first, and is to be seen to
};

struct OperatorRequest {
  Request kind = Request::go_on;
  std::string text;  // the reason, or the note
};

// Where the session stands, as the operator may see it.
struct TrialOutline {
  int number = 0;  // k of n in the main part, or in the practice round: how far the session is
  int total = 0;
  int plan_number = 0;   // Trial::index: its place in the plan, as exports count
  bool at_most = false;  // the answers may end the session before `total`
  bool practice = false;
  int round = 0;  // of practice
  int attempt = 1;
  int block = 0, blocks = 0;  // of the main part
  // "A", "B", ...: the same letter for a condition throughout the study. Empty in practice, whose conditions come in
  // the protocol's own order, which would say what the letters stand for.
  std::string condition_code;
  // What participants are told to do in its intervals, and the pace of a metronome in them (0: none).
  std::string prescribed;
  double pace_hz = 0;
  double time_left_s = 0;      // of the session, its questions and breaks, at the participant's own pace
  bool can_void_last = false;  // there is a last answer, of the same part of the session, to take back
};

// Progress of one coded condition in the main part.
struct ConditionProgress {
  std::string code;
  int done = 0, total = 0;
};

// How the devices do while a presentation goes on, and how they did in the last one. Nothing here follows from a force
// or a limit: those tell the stimulus, and whether the condition has force at all. Whether fingers are in the object is
// known from where they are, in every condition alike.
struct DeviceHealth {
  bool presenting = false;  // otherwise the devices are at rest
  double elapsed_s = 0;     // of the presentation, while presenting
  bool contact = false;     // while presenting
  double rate_hz = 0;       // of the control loop; 0: unknown
  double lateness_max_us = 0;
  std::string fault{};  // what a device or the loop could not do; empty: nothing. A stop is none.
};

// Free interaction: what the operator may see of it.
struct ExplorationOutline {
  int number = 0, total = 0;
  std::string condition_code;
  std::string object;  // its name in the protocol
  bool devices = true;
  double duration_s = 0;
  int attempt = 1;
};

// Specimens to hand over now: what is written on each, and where it goes ("left") or which interval it is for ("second";
// empty where there is one).
struct HandOver {
  struct Item {
    std::string place, code;
  };
  std::vector<Item> items;
  std::string condition;  // its label and parameters: the operator's hands carry it out
};

enum class CuePlace { first, second, third, question };

// Thread rule: called by the session's thread only. Defaults suit a session without a person.
class SessionView {
 public:
  virtual ~SessionView() = default;
  // Before a trial: go_on presents it; anything else is done, and this is asked again where a trial is still to come.
  // Whatever asks for a request may return stopped; it is asked again once the stop is cleared.
  virtual OperatorRequest ready(const TrialOutline&) { return {}; }
  // What the operator asked for during a presentation, or instead of an answer: repeat_trial, or an end.
  virtual OperatorRequest meanwhile() { return {}; }
  // The session stands still, with the devices neutral. go_on ends the pause; note, end_for_now and end_for_good do
  // what they say.
  virtual OperatorRequest paused(const std::string& /*cause*/) { return {Request::end_for_now, {}}; }
  virtual void progress(const std::vector<ConditionProgress>&) {}
  // Before each step of the session: how long it will last yet, with questions and breaks, at the participant's own pace.
  // The same whatever the coming trials present.
  virtual void time_left(double /*left_s*/) {}
  virtual void health(const DeviceHealth&) {}
  virtual void cue(CuePlace, const CueSignal&) {}
  // Before an interval, where the operator's hands are the rig: go_on once the participant has what is named.
  virtual OperatorRequest hand_over(const HandOver&) { return {}; }
  // Until the next trial may begin; called some times a second. False: the operator wants something, which is ready()'s
  // to say.
  virtual bool waiting(double /*left_s*/, double /*total_s*/) { return true; }
  // Between two intervals of a trial; called some times a second. False: the operator wants something, which meanwhile() says.
  virtual bool gap(double /*left_s*/, double /*total_s*/) { return true; }
  // After the answer's transaction is committed, and not before.
  virtual void saved(const TrialOutline&, const Answer&) {}
  virtual void voided(const TrialOutline&, const std::string& /*reason*/, bool /*will_repeat*/) {}
  // The trial that was saved broke the prescription. By how much may tell the stimulus, so it is not said here.
  virtual void off_prescription(const TrialOutline&) {}
  // Every now and then, where it is true: by the rig's own measure it did not deliver what was asked. So far in the session,
  // and at times that no stimulus sets: in which interval could tell it.
  virtual void not_as_asked(const Deliveries&) {}
  // The last answer was taken back.
  virtual void took_back(bool /*will_repeat*/) {}
  // After an emergency stop, with the devices at rest: go_on clears it, its text is the operator's reason; an end ends
  // the session here.
  virtual OperatorRequest recover(const std::string& /*stopped_by*/) { return {Request::end_for_now, {}}; }
  // Something of the rig is missing, such as a device that was unplugged; `what` is in the operator's words. Returns
  // go_on as soon as back() is true, which it asks some times a second, or what the operator asks for meanwhile; at once
  // for views without a person.
  virtual OperatorRequest missing(const std::string& /*what*/, const std::function<bool()>& /*back*/) { return {}; }
  // The log cannot be written just now: true tries again, false ends the session, and what was not saved is lost.
  virtual bool storage_trouble(const std::string& /*message*/) { return false; }
  virtual void feedback(bool /*correct*/) {}
  virtual void practice_over(int /*rounds*/, double /*share_correct*/, bool /*passed*/) {}
  virtual void break_begins(const Break&, bool /*asked_by_operator*/) {}
  // Returns when the break is over: at once for views without a person.
  virtual OperatorRequest break_over(const Break&) { return {}; }
  // A page to read out or to show; in the participant's language.
  virtual OperatorRequest instruct(const Instruction&) { return {}; }
  // Whether the participant consents; nothing where a signal or a stop came first.
  virtual std::optional<bool> consent(const std::string& /*text*/) { return true; }
  // Before free interaction with an object.
  virtual OperatorRequest ready_to_explore(const ExplorationOutline&) { return {}; }
  // It goes on; called some times a second. False ends it (see meanwhile()).
  virtual bool exploring(double /*left_s*/) { return true; }
  // After its transaction is committed, and not before.
  virtual void explored() {}
};

}  // namespace jnd
