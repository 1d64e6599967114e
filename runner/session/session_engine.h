// One session, from the first question to the last: the same engine for people and for simulated participants.
//
// The engine owns nothing durable. Every answer is one committed event, and the state it starts from is a replay of the
// events so far: kill it anywhere, run it again with the replayed state, and it goes on at the next unanswered trial.
// What comes when says the course (protocols/course/course.h); the engine carries out one step after the other. How a
// trial goes is in trial_conductor.h, how free interaction goes in exploration_block.h.
#pragma once

#include <string>
#include <vector>

#include "protocols/course/course.h"
#include "runner/session/course_recorder.h"
#include "runner/session/exploration_block.h"
#include "runner/session/session_parts.h"
#include "runner/session/trial_conductor.h"

namespace jnd {

enum class SessionEnd {
  completed,     // everything asked and answered; the caller closes the session
  closed_early,  // the operator ended it for good, or there was no consent; the caller closes it
  interrupted    // the operator or a signal ended it; resumable
};

// What the protocol wants after an interruption (ResumePolicy), as decided by the caller.
struct ResumeSteps {
  bool redo_block = false;
  bool practice_again = false;
};

class SessionEngine {
 public:
  explicit SessionEngine(const SessionParts& parts);

  // state: replay of the log's events. Throws StorageError where an event cannot be written (nothing is lost: what was
  // said to be saved is saved).
  SessionEnd run(const SessionState& state, ResumeSteps steps = {});
  // Where it stands.
  const Course& course() const noexcept { return course_; }

 private:
  void go_through();
  void carry_out(const step::TakeBack& due);
  void carry_out(const step::SettleTrial& due);
  void carry_out(const step::CheckList& due);
  void carry_out(const step::Instruct& due);
  void carry_out(const step::AskConsent& due);
  void carry_out(const step::Ask& due);
  void carry_out(const step::Present& due);
  void carry_out(const step::GiveUp& due);
  void carry_out(const step::EndPractice& due);
  void carry_out(const step::TakeBreak& due);
  void carry_out(const step::SettleExploration& due) { explorations_.settle_attempt(due); }
  void carry_out(const step::Explore& due) { explorations_.explore(due); }
  void carry_out(const step::Done&) {}

  Replies replies_to(const std::vector<AskedQuestion>& page);
  // The operator's word before a trial. False: what is next has changed.
  bool ready(const Trial& next, const TrialOutline& outline);
  void end_block(const Trial& next, const std::string& reason);
  void take_back_last(const TrialRecord& last, const std::string& words);
  void break_on_request(const std::string& reason);
  void say_progress();
  std::vector<ConditionProgress> by_condition() const;
  TrialOutline outline_of(const Trial& trial) const;
  double time_left_s() const;
  int after_trial() const noexcept { return course_.main_done(); }

  const SessionParts& parts_;
  const Protocol& protocol_;
  const Plan& plan_;
  Course course_;
  CourseRecorder recorder_;
  ExplorationBlock explorations_;
  TrialConductor conductor_;
  std::vector<std::string> codes_;  // of the conditions
  int blocks_ = 0;
  double seconds_in_trials_ = 0;  // of this run, for the time left
  int trials_timed_ = 0;
};

}  // namespace jnd
