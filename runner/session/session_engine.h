// One session, from the first question to the last: the same engine for people and for simulated participants.
//
// The engine owns nothing durable. Every answer is one committed event, and the state it starts from is a replay of the
// events so far: kill it anywhere, run it again with the replayed state, and it goes on at the next unanswered trial.
// How a trial goes is in trial_conductor.h, what is still to do in session_progress.h; what people are asked around the
// trials is in session_questions.cpp.
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "data/log/event_body.h"
#include "protocols/planning/condition_codes.h"
#include "runner/session/session_parts.h"
#include "runner/session/session_progress.h"
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

 private:
  enum class BlockEnd { over, reordered };  // reordered: a trial of an earlier block is open again

  void open_session(ResumeSteps steps);
  void settle_pending(bool in_its_place);  // or at the end of its block
  void redo_interrupted_block();
  void practise_again();
  void take_back(const Trial& trial, int attempt, bool anew, const std::string& reason);
  Replies replies_to(const std::vector<AskedQuestion>& page);
  void check_list();
  void instruct(Instruction::When when);
  void consent();
  void ask(Question::When when, int condition, int after_trial);
  void run_practice();
  bool run_main();  // false: some block is open again
  BlockEnd run_block(const std::vector<Trial>& block);
  // The operator's word before a trial. False: the queue of trials has changed.
  bool ready(const Trial& next, const TrialOutline& outline, const std::vector<Trial>& left, BlockEnd& end);
  void end_block(const std::vector<Trial>& left, const std::string& reason);
  void take_back_last(const TrialRecord& last, const std::string& words);
  void give_up(const Trial& trial);
  void take_breaks_within_block();
  void take_breaks(int planned, bool series_over);
  void take_break(const Break& pause, int after_trial);
  void break_on_request(const std::string& reason);
  void say_progress();
  std::vector<std::vector<Trial>> main_blocks() const;
  TrialOutline outline_of(const Trial& trial) const;
  int after_trial() const noexcept { return progress_.main_done(); }

  const SessionParts& parts_;
  const Protocol& protocol_;
  const Plan& plan_;
  SessionRecorder recorder_;
  TrialConductor conductor_;
  SessionProgress progress_;
  std::vector<std::string> codes_;  // of the conditions
  int blocks_ = 0;
  double seconds_in_trials_ = 0;  // of this run, for the time left
  int trials_timed_ = 0;
};

}  // namespace jnd
