// How far a session has come: what is done, what is still to do and in which order, and which attempt comes next. A
// replay of the log gives the same state as the session that wrote it had.
#pragma once

#include <deque>
#include <map>
#include <string>
#include <unordered_set>
#include <vector>

#include "data/log/event_body.h"
#include "protocols/planning/adaptive_run.h"
#include "protocols/planning/plan.h"
#include "protocols/protocol.h"
#include "runner/session/session_view.h"

namespace jnd {

class SessionProgress {
 public:
  // protocol and plan must outlive it.
  SessionProgress(const Protocol& protocol, const Plan& plan);
  // Goes on from what a log says.
  void start(SessionState state);

  // The trials of a block that are still to do: those never tried in the planned order, then the voided ones in the
  // order in which they failed.
  std::deque<Trial> open_trials(const std::vector<Trial>& block) const;
  // An adaptive level is known when its turn comes.
  Trial resolved(const Trial& planned) const { return adaptive_.resolved(planned); }
  // Its track has its reversals already.
  bool over(const Trial& planned) const { return adaptive_.over(planned); }

  // What the log was told, after it was told.
  void began(const Trial& trial, int attempt) { state_.attempts[trial.index] = attempt; }
  void answered(const TrialRecord& record);
  // anew: as if it had never been tried, in its planned place; otherwise it goes to the end of its block.
  void voided(const Trial& trial, int attempt, bool counts, bool anew = false);
  void given_up(const Trial& trial);

  // The last answer, where it may be taken back: of this practice round, or of the main part.
  const TrialRecord* last_answer(const Trial& next) const;
  // It was taken back.
  void forget_last_answer();
  // An answer that an interruption takes back, with its block or its practice round.
  void forget_answer(int index);

  int next_attempt(int index) const;
  int attempts_used(int index) const;
  bool finished(int index) const { return finished_.contains(index); }
  int main_done() const noexcept { return main_done_; }  // answered or given up
  int main_left() const;                                 // at most so many where the answers may end a track
  int round_answered(int round) const;                   // of a practice round
  int round_correct(int round) const;
  std::vector<ConditionProgress> by_condition(const std::vector<std::string>& codes) const;

  const SessionState& state() const noexcept { return state_; }
  SessionState& state() noexcept { return state_; }  // for what is not about trials: questions, breaks

 private:
  void remember(const TrialRecord& record);
  void replay_answers();

  const Protocol& protocol_;
  const Plan& plan_;
  SessionState state_;
  AdaptiveRun adaptive_;
  std::unordered_set<int> finished_;  // indices of trials answered or given up
  struct RoundTally {
    int answered = 0, correct = 0;
  };
  std::map<int, RoundTally> practice_;  // by round
  int main_total_ = 0;
  int main_done_ = 0;
  bool may_take_back_ = true;  // one answer, not one after the other
};

}  // namespace jnd
