#include "runner/session/session_progress.h"

#include <algorithm>
#include <utility>

namespace jnd {

SessionProgress::SessionProgress(const Protocol& protocol, const Plan& plan)
    : protocol_(protocol), plan_(plan), adaptive_(protocol), main_total_(main_trial_count(plan)) {}

void SessionProgress::start(SessionState state) {
  state_ = std::move(state);
  may_take_back_ = !state_.taken_back;
  replay_answers();
}

void SessionProgress::replay_answers() {
  adaptive_ = AdaptiveRun(protocol_);
  practice_.clear();
  finished_ = {state_.abandoned.begin(), state_.abandoned.end()};
  for (const TrialRecord& record : state_.completed) remember(record);
  main_done_ = static_cast<int>(std::count_if(plan_.trials.begin(), plan_.trials.end(), [&](const Trial& trial) {
    return !trial.practice && finished_.contains(trial.index);
  }));
}

void SessionProgress::remember(const TrialRecord& record) {
  finished_.insert(record.trial.index);
  adaptive_.answered(record.trial, record.answer.judgement);
  if (!record.trial.practice) return;
  RoundTally& tally = practice_[record.trial.round];
  ++tally.answered;
  tally.correct += record.trial.same == (record.answer.judgement == Judgement::same) ? 1 : 0;
}

std::deque<Trial> SessionProgress::open_trials(const std::vector<Trial>& block) const {
  const std::unordered_set<int> failed(state_.void_order.begin(), state_.void_order.end());
  const auto open = [&](const Trial& trial) { return !finished_.contains(trial.index) && !adaptive_.over(trial); };
  std::deque<Trial> queue;
  for (const Trial& trial : block)
    if (open(trial) && !failed.contains(trial.index)) queue.push_back(trial);
  for (const int index : state_.void_order)
    for (const Trial& trial : block)
      if (trial.index == index && open(trial)) queue.push_back(trial);
  return queue;
}

void SessionProgress::answered(const TrialRecord& record) {
  state_.attempts[record.trial.index] = record.attempt;
  state_.completed.push_back(record);
  may_take_back_ = true;
  remember(record);
  if (!record.trial.practice) ++main_done_;
}

void SessionProgress::voided(const Trial& trial, int attempt, bool counts, bool anew) {
  state_.attempts[trial.index] = attempt;
  if (counts) ++state_.voided[trial.index];
  std::erase(state_.void_order, trial.index);
  if (!anew) state_.void_order.push_back(trial.index);
}

void SessionProgress::given_up(const Trial& trial) {
  state_.abandoned.insert(trial.index);
  finished_.insert(trial.index);
  if (!trial.practice) ++main_done_;
}

const TrialRecord* SessionProgress::last_answer(const Trial& next) const {
  if (!may_take_back_ || state_.completed.empty()) return nullptr;
  const TrialRecord& last = state_.completed.back();
  const bool reachable = last.trial.practice == next.practice && last.trial.round == next.round;
  return reachable ? &last : nullptr;
}

void SessionProgress::forget_last_answer() {
  state_.completed.pop_back();
  may_take_back_ = false;
  replay_answers();  // an adaptive track goes back by that answer
}

void SessionProgress::forget_answer(int index) {
  std::erase_if(state_.completed, [&](const TrialRecord& record) { return record.trial.index == index; });
  replay_answers();
}

int SessionProgress::next_attempt(int index) const {
  const auto found = state_.attempts.find(index);
  return 1 + (found == state_.attempts.end() ? 0 : found->second);
}

int SessionProgress::attempts_used(int index) const {
  const auto found = state_.voided.find(index);
  return found == state_.voided.end() ? 0 : found->second;
}

int SessionProgress::main_left() const {
  if (!protocol_.design.procedure) return main_total_ - main_done_;
  return static_cast<int>(std::count_if(plan_.trials.begin(), plan_.trials.end(), [&](const Trial& trial) {
    return !trial.practice && !finished_.contains(trial.index) && !adaptive_.over(trial);
  }));
}

int SessionProgress::round_answered(int round) const {
  const auto found = practice_.find(round);
  return found == practice_.end() ? 0 : found->second.answered;
}

int SessionProgress::round_correct(int round) const {
  const auto found = practice_.find(round);
  return found == practice_.end() ? 0 : found->second.correct;
}

std::vector<ConditionProgress> SessionProgress::by_condition(const std::vector<std::string>& codes) const {
  std::vector<ConditionProgress> progress(codes.size());
  for (std::size_t i = 0; i < codes.size(); ++i) progress[i].code = codes[i];
  for (const Trial& trial : plan_.trials) {
    if (trial.practice) continue;
    ConditionProgress& condition = progress[static_cast<std::size_t>(trial.condition)];
    const bool done = finished_.contains(trial.index);
    condition.done += done ? 1 : 0;
    condition.total += done || !adaptive_.over(trial) ? 1 : 0;
  }
  std::sort(progress.begin(), progress.end(),
            [](const ConditionProgress& a, const ConditionProgress& b) { return a.code < b.code; });
  return progress;
}

}  // namespace jnd
