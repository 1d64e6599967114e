// The operator's console: what to do and to say now, trial k of n, the coded condition, the time left, the devices'
// health; and what the operator asks for. It never shows a stimulus, an answer's correctness (unless the protocol gives
// the participant that feedback) or a condition's name.
//
// Two faces, one behaviour: a calm full screen, or lines (--plain, and where input or output is no terminal).
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "devices/clock.h"
#include "devices/emergency_stop.h"
#include "devices/responder.h"
#include "protocols/protocol.h"
#include "protocols/vocabulary.h"
#include "runner/keys/interrupt.h"
#include "runner/session/session_view.h"

namespace jnd {

class ButtonBox;
class Keyboard;
class SessionListener;
class TelemetryRing;

// What is said of a session once, at its beginning.
struct SessionCard {
  std::string title;        // of the protocol
  std::string participant;  // code
  std::string group;        // of the participant; empty where the operator may not know it
  int session = 1, sessions = 1;
  SessionKind kind = SessionKind::pilot;
  bool resumed = false;
  int trials_done = 0, trials_total = 0;  // of the main part
  bool fast = false;                      // waiting takes no time
  bool unblinded = false;                 // the operator sees forces
};

// Force and depth of every device, for a technician's eyes.
struct LiveForces {
  TelemetryRing* ticks = nullptr;      // outlive the console
  std::vector<std::string> devices{};  // names, in the order of TickRecord::channel
  bool in_metres = true;               // depth; otherwise in rad
};

struct ConsoleOptions {
  bool plain = false;                           // lines, also on a terminal
  EnteredBy entered_by = EnteredBy::operator_;  // of answers by keys
  ButtonBox* buttons = nullptr;                 // the participant's own, where there are some; outlives the console
  RigButtons* rig_buttons = nullptr;            // the rig's, where it has some; outlive the console
  std::vector<SessionListener*> listeners{};    // hear what the screen is told; they outlive the console
  const EmergencyStop* stop = nullptr;          // the rig's, which waits look at; outlives the console
  bool alerts = true;  // the terminal's bell where the operator is to look up: a question, a fault, the end of a break
  std::optional<LiveForces> forces{};  // shown; the session is marked as unblinded
  bool large_text = false;             // the participant's texts in large letters, on a screen; Ctrl-L changes it
};

// Thread rule: the session's thread only.
//
// Interrupts: every wait looks at them. Where `pause` is set, ready(), instruct(), break_over() and ready_to_explore()
// return Request::pause, a trial or a page of questions is left without an answer, and what was typed on the page is there
// when it is asked again; the latch itself is left to the engine. Where `end` is set, or the keys have ended, a wait
// returns Request::end_for_now, nothing, or false.
// Stops: where a key or a button has latched the rig's stop, every wait returns at once with Request::stopped or without
// an answer, but for recover()'s and those in it, and storage_trouble()'s, which comes before the stop. A text to be
// read (consent, instructions, a page of questions, a finding) takes no answer before all of it was seen. judge()
// returns nothing where the operator asks for something instead of the answer: meanwhile() then says what. What was
// typed during a presentation and does not break it off (pause, note, end) is the next ready()'s.
class Console : public SessionView {
 public:
  virtual Responder& responder() = 0;
  virtual void begin(const SessionCard& card) = 0;
  // A message of its own, of one line or several: what readiness found, a clock that was set back.
  virtual void announce(const std::string& text, bool warning) = 0;
  // [y] or [n]; false also without a keyboard.
  virtual bool confirm(const std::string& question) = 0;
  // A line of text, such as the reason for going on in spite of a finding; may be empty.
  virtual std::string ask_text(const std::string& question) = 0;
  // Puts the terminal back and prints the last words there. Later calls print lines.
  virtual void end(const std::string& last_words) = 0;
};

}  // namespace jnd
