// The operator's console, a line at a time: what to do now, trial k of n, the coded condition, the time left.
// It never shows a stimulus, an answer's correctness (unless the protocol gives the participant that feedback) or a
// condition's name.
#pragma once

#include <string>

#include "devices/clock.h"
#include "devices/responder.h"
#include "runner/keyboard.h"
#include "runner/session_view.h"

namespace jnd {

class ConsoleView final : public SessionView {
 public:
  // keyboard: null for a live demo, in which nobody presses keys. Both must outlive the view.
  ConsoleView(Keyboard* keyboard, Clock& clock) noexcept : keyboard_(keyboard), clock_(clock) {}

  bool ready(const TrialOutline& outline) override;
  void cue(CuePlace place, const CueSignal& cue) override;
  void saved(const TrialOutline& outline, const Answer& answer) override;
  void voided(const TrialOutline& outline, const std::string& reason, bool will_repeat) override;
  bool recover(const std::string& stopped_by) override;
  void feedback(bool correct) override;
  void practice_over(int rounds, double share_correct, bool passed) override;
  void break_begins(const Break& pause) override;
  bool break_over(const Break& pause) override;

 private:
  bool wait_for_space();

  Keyboard* keyboard_;
  Clock& clock_;
};

class KeyboardResponder final : public Responder {
 public:
  KeyboardResponder(const Protocol& protocol, Keyboard& keyboard, Clock& clock, EnteredBy entered_by) noexcept
      : protocol_(protocol), keyboard_(keyboard), clock_(clock), entered_by_(entered_by) {}

  // None on time-out; on 'q', Ctrl-C or the end of input the program's interrupt latch is set as well.
  std::optional<Answer> judge(const TrialQuestion& question) override;
  std::optional<std::string> reply(const Question& question, int condition) override;

 private:
  const Protocol& protocol_;
  Keyboard& keyboard_;
  Clock& clock_;
  EnteredBy entered_by_;
};

}  // namespace jnd
