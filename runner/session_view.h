// What the engine tells the person at the terminal. It never tells a stimulus, nor a condition's real name.
#pragma once

#include <string>

#include "protocols/protocol.h"
#include "protocols/vocabulary.h"

namespace jnd {

// Where the session stands, as the operator may see it.
struct TrialOutline {
  int number = 0;  // k of n in the main part, or in the practice round
  int total = 0;
  bool at_most = false;  // the answers may end the session before `total`
  bool practice = false;
  int round = 0;  // of practice
  int attempt = 1;
  int block = 0, blocks = 0;   // of the main part
  std::string condition_code;  // "A", "B", ...: the same letter for a condition throughout the study
  double time_left_s = 0;      // at the participant's own pace
};

enum class CuePlace { first, second, question };

// Thread rule: called by the session's thread only.
class SessionView {
 public:
  virtual ~SessionView() = default;
  // Before a trial: false ends the session here (it can be resumed).
  virtual bool ready(const TrialOutline&) { return true; }
  virtual void cue(CuePlace, const CueSignal&) {}
  // After the answer's transaction is committed, and not before.
  virtual void saved(const TrialOutline&, const Answer&) {}
  virtual void voided(const TrialOutline&, const std::string& /*reason*/, bool /*will_repeat*/) {}
  // After an emergency stop, with the devices at rest: true clears it and goes on, false ends the session here.
  virtual bool recover(const std::string& /*stopped_by*/) { return false; }
  virtual void feedback(bool /*correct*/) {}
  virtual void practice_over(int /*rounds*/, double /*share_correct*/, bool /*passed*/) {}
  virtual void break_begins(const Break&) {}
  // Returns when the break is over: at once for views without a person.
  virtual bool break_over(const Break&) { return true; }
};

}  // namespace jnd
