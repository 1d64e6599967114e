#include "protocols/course/session_state.h"

#include <algorithm>

namespace jnd {

namespace {

// Applies one event to the state.
class Applying {
 public:
  explicit Applying(SessionState& state) noexcept : state_(state) {}

  void operator()(const SessionOpened& event) const {
    state_.opened = true;
    state_.boot_id = event.boot_id;
  }
  void operator()(const SessionResumed& event) const {
    state_.boot_id = event.boot_id;
    state_.checked.clear();
    state_.redo_due = event.redo_block;
    if (!event.practice_again) return;
    state_.practice_ended = false;
    state_.practice_due = true;
  }
  void operator()(const SessionClosed&) const { state_.closed = true; }
  void operator()(const SessionLeft& event) const { state_.ended_for_good = state_.ended_for_good || event.for_good; }
  void operator()(const ItemChecked& event) const { state_.checked.insert(event.id); }
  void operator()(const InstructionShown& event) const { state_.instructed.insert(event.id); }
  void operator()(const ConsentAsked& event) const { state_.consented = event.given; }
  void operator()(const QuestionAnswered& event) const { state_.answered.insert(event.key); }
  void operator()(const BreakTaken& event) const { state_.breaks_after.insert(event.after_trial); }

  void operator()(const TrialBegan& event) const {
    state_.pending = PendingTrial{event.index, event.attempt};
    attempted(event.index, event.attempt);
    state_.redo_due = false;
  }
  void operator()(const TrialAnswered& event) const {
    state_.completed.push_back(event.record);
    if (event.record.trial.practice) state_.practice_due = false;
    state_.taken_back = state_.redo_due = false;
    attempted(event.record.trial.index, event.record.attempt);
    settle(event.record.trial.index);
  }
  void operator()(const TrialVoided& event) const {
    if (event.taken_back) state_.taken_back = true;
    attempted(event.index, event.attempt);
    if (event.counts) ++state_.voided[event.index];
    std::erase(state_.void_order, event.index);
    if (!event.anew) {
      state_.void_order.push_back(event.index);
      state_.redo_due = false;
    }
    std::erase_if(state_.completed, [&](const TrialRecord& record) {
      return record.trial.index == event.index && record.attempt == event.attempt;
    });
    settle(event.index);
  }
  void operator()(const TrialGivenUp& event) const {
    state_.abandoned.insert(event.index);
    state_.redo_due = false;
    settle(event.index);
  }
  void operator()(const BlockEnded& event) const {
    for (const int index : event.trials) {
      state_.abandoned.insert(index);
      settle(index);
    }
    state_.redo_due = false;
    if (event.practice) end_practice();
  }
  void operator()(const PracticeEnded&) const { end_practice(); }

  void operator()(const ExplorationBegan& event) const {
    attempted_exploration(event.index, event.attempt);
    state_.exploration.pending = event.index;
  }
  void operator()(const ExplorationEnded& event) const {
    attempted_exploration(event.index, event.attempt);
    state_.explored.insert(event.index);
  }
  void operator()(const ExplorationVoided& event) const {
    attempted_exploration(event.index, event.attempt);
    state_.explored.erase(event.index);
    if (event.counts) ++state_.exploration.used[event.index];
    if (!event.will_repeat) state_.exploration.given_up.insert(event.index);
  }

 private:
  void attempted(int index, int attempt) const {
    int& highest = state_.attempts[index];
    highest = std::max(highest, attempt);
  }
  // The trial is done with, whatever became of it.
  void settle(int index) const {
    if (state_.pending && state_.pending->index == index) state_.pending.reset();
  }
  void end_practice() const {
    state_.practice_ended = true;
    state_.practice_due = false;
  }
  // A new attempt, or the end of the one under way.
  void attempted_exploration(int index, int attempt) const {
    int& highest = state_.exploration.attempts[index];
    highest = std::max(highest, attempt);
    if (state_.exploration.pending == index) state_.exploration.pending.reset();
  }

  SessionState& state_;
};

}  // namespace

void apply(const CourseEvent& event, SessionState& state) {
  std::visit(Applying(state), event);
}

std::string question_key(std::string_view id, std::string_view condition, int after_trial) {
  std::string key(id);
  if (!condition.empty()) key.append("/").append(condition);
  if (after_trial > 0) key.append("@").append(std::to_string(after_trial));
  return key;
}

}  // namespace jnd
