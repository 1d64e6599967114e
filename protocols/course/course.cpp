#include "protocols/course/course.h"

#include <algorithm>
#include <utility>

#include "protocols/planning/allotment.h"
#include "protocols/tasks/task.h"

namespace jnd {

namespace {

// Indices are places in the plan, from 1; those of a damaged log can be anything.
bool within(int index, std::size_t size) {
  return index >= 0 && static_cast<std::size_t>(index) < size;
}

std::size_t size_by_index(const Plan& plan) {
  int highest = 0;
  for (const Trial& trial : plan.trials) highest = std::max(highest, trial.index);
  return static_cast<std::size_t>(highest) + 1;
}

void number_blocks(std::vector<CourseBlock>& blocks) {
  int planned = 0;
  for (CourseBlock& block : blocks) {
    planned += static_cast<int>(block.end - block.begin);
    block.planned = planned;
    block.last = &block == &blocks.back();
  }
}

}  // namespace

std::vector<CourseBlock> course_blocks(const Protocol& protocol, const Plan& plan) {
  std::vector<CourseBlock> blocks;
  const auto add = [&](std::size_t place, int condition) {
    blocks.back().end = place + 1;
    blocks.back().condition = condition;
  };
  for (std::size_t i = 0; i < plan.explorations.size(); ++i) {
    const ExplorationSlot& slot = plan.explorations[i];
    if (i == 0 || plan.explorations[i - 1].block != slot.block) blocks.push_back({.begin = i});
    add(i, slot.condition);
  }
  const Trial* before = nullptr;
  for (std::size_t i = 0; i < plan.trials.size(); ++i) {
    const Trial& trial = plan.trials[i];
    if (trial.practice) continue;
    if (before == nullptr || before->block != trial.block) {
      if (before != nullptr) blocks.back().series_over = before->series != trial.series;
      blocks.push_back({.begin = i, .one_condition = protocol.design.arrangement == Arrangement::blocked});
    }
    add(i, trial.condition);
    before = &trial;
  }
  if (before != nullptr) blocks.back().series_over = true;
  number_blocks(blocks);
  return blocks;
}

std::vector<CourseBlock> course_blocks(const Protocol& protocol) {
  std::vector<CourseBlock> blocks;
  const bool mixed = protocol.design.arrangement == Arrangement::mixed;
  const std::vector<int> conditions = conditions_of(protocol, largest_plan(protocol));
  // Of a condition's turn in each series; objects are explored in one turn.
  std::vector<std::size_t> turns;
  if (protocol.explore) turns = {protocol.explore->objects.size()};
  for (const Series& series : protocol.series)
    turns.push_back(static_cast<std::size_t>(trials_of_cell(protocol, series)) * (mixed ? conditions.size() : 1));
  std::size_t place = 0;
  for (const std::size_t each : turns) {
    for (std::size_t turn = mixed ? conditions.size() - 1 : 0; turn < conditions.size(); ++turn) {
      blocks.push_back({.begin = place,
                        .end = place + each,
                        .condition = conditions[turn],
                        .one_condition = !mixed,
                        .series_over = !protocol.explore && turn + 1 == conditions.size()});
      place = blocks.back().end;
    }
  }
  number_blocks(blocks);
  return blocks;
}

std::vector<CoursePage> pages_after(const CourseBlock& block) {
  std::vector<CoursePage> pages;
  if (block.one_condition) pages.push_back({Question::When::after_condition, block.condition, block.planned});
  if (block.series_over) pages.push_back({Question::When::after_series, -1, block.planned});
  return pages;
}

std::vector<AskedPlace> questions_on(const CoursePage& page, const Protocol& protocol,
                                     const std::vector<int>& conditions) {
  std::vector<AskedPlace> asked;
  for (std::size_t i = 0; i < protocol.questions.size(); ++i) {
    const Question& question = protocol.questions[i];
    if (question.when != page.when) continue;
    if (question.per_condition) {
      for (const int condition : conditions) asked.push_back({static_cast<int>(i), condition});
    } else {
      asked.push_back({static_cast<int>(i), page.condition});
    }
  }
  return asked;
}

const Break* break_after(const CourseBlock& block, const Protocol& protocol) {
  if (block.last) return nullptr;
  for (const Break& pause : protocol.breaks)
    if (pause.after == Break::After::block || (pause.after == Break::After::series && block.series_over) ||
        (pause.after == Break::After::trials && block.planned % pause.trials == 0))
      return &pause;
  return nullptr;
}

const Break* break_within_block(int main_done, const Protocol& protocol) {
  for (const Break& pause : protocol.breaks)
    if (pause.after == Break::After::trials && main_done > 0 && main_done % pause.trials == 0) return &pause;
  return nullptr;
}

Course::Course(const Protocol& protocol, const Plan& plan, bool person)
    : protocol_(protocol), plan_(plan), person_(person), blocks_(course_blocks(protocol, plan)), adaptive_(protocol) {
  for (std::size_t i = 0; i < plan.trials.size(); ++i) {
    const Trial& trial = plan.trials[i];
    if (!trial.practice) continue;
    if (i == 0 || plan.trials[i - 1].round != trial.round) rounds_.push_back({i, i});
    rounds_.back().end = i + 1;
  }
  start({});
}

void Course::start(SessionState state) {
  state_ = std::move(state);
  failed_.assign(size_by_index(plan_), 0);
  for (const int index : state_.void_order) mark_failed(index, true);
  follow_answers();
}

void Course::apply(const CourseEvent& event) {
  const std::size_t answers = state_.completed.size();
  jnd::apply(event, state_);
  if (const auto* voided = std::get_if<TrialVoided>(&event)) mark_failed(voided->index, !voided->anew);
  if (const auto* given_up = std::get_if<TrialGivenUp>(&event)) finish(given_up->index);
  if (const auto* ended = std::get_if<BlockEnded>(&event))
    for (const int index : ended->trials) finish(index);
  if (std::holds_alternative<TrialAnswered>(event))
    follow(state_.completed.back());
  else if (state_.completed.size() != answers)
    follow_answers();  // an adaptive track goes back by what was taken back
}

void Course::follow_answers() {
  adaptive_ = AdaptiveRun(protocol_);
  practice_.assign(rounds_.size() + 1, {});
  finished_.assign(size_by_index(plan_), 0);
  main_done_ = 0;
  for (const int index : state_.abandoned) finish(index);
  for (const TrialRecord& record : state_.completed) follow(record);
}

void Course::follow(const TrialRecord& record) {
  finish(record.trial.index);
  adaptive_.answered(record.trial, record.answer);
  if (!record.trial.practice || !within(record.trial.round, practice_.size())) return;
  Tally& tally = practice_[static_cast<std::size_t>(record.trial.round)];
  ++tally.answered;
  tally.correct += is_correct(record.trial, record.answer).value_or(true) ? 1 : 0;
}

void Course::finish(int index) {
  const Trial* trial = planned(index);
  if (trial == nullptr || finished(index)) return;
  finished_[static_cast<std::size_t>(index)] = 1;
  if (!trial->practice) ++main_done_;
}

void Course::mark_failed(int index, bool failed) {
  if (within(index, failed_.size())) failed_[static_cast<std::size_t>(index)] = failed ? 1 : 0;
}

const Trial* Course::planned(int index) const {
  if (index < 1 || static_cast<std::size_t>(index) > plan_.trials.size()) return nullptr;
  return &plan_.trials[static_cast<std::size_t>(index - 1)];
}

bool Course::finished(int index) const {
  return within(index, finished_.size()) && finished_[static_cast<std::size_t>(index)] != 0;
}

bool Course::exploration_over(int index) const {
  return state_.explored.contains(index) || state_.exploration.given_up.contains(index);
}

int Course::explorations_done() const {
  return static_cast<int>(state_.explored.size() + state_.exploration.given_up.size());
}

int Course::next_attempt(int index) const {
  const auto found = state_.attempts.find(index);
  return 1 + (found == state_.attempts.end() ? 0 : found->second);
}

int Course::next_exploration_attempt(int index) const {
  const auto found = state_.exploration.attempts.find(index);
  return 1 + (found == state_.exploration.attempts.end() ? 0 : found->second);
}

int Course::attempts_used(int index) const {
  const auto found = state_.voided.find(index);
  return found == state_.voided.end() ? 0 : found->second;
}

int Course::main_left() const {
  return static_cast<int>(std::count_if(plan_.trials.begin(), plan_.trials.end(),
                                        [&](const Trial& trial) { return !trial.practice && open(trial); }));
}

int Course::round_answered(int round) const {
  return within(round, practice_.size()) ? practice_[static_cast<std::size_t>(round)].answered : 0;
}

int Course::practice_left() const {
  if (!protocol_.practice || state_.practice_ended) return 0;
  for (std::size_t i = 0; i < rounds_.size(); ++i) {
    const auto trial = [this](std::size_t place) { return plan_.trials.begin() + static_cast<std::ptrdiff_t>(place); };
    const auto left = std::count_if(trial(rounds_[i].begin), trial(rounds_[i].end),
                                    [this](const Trial& planned) { return open(planned); });
    if (left > 0) return static_cast<int>(left);
    if (end_of_practice(static_cast<int>(i) + 1).passed) return 0;
  }
  return 0;
}

Course::Span Course::span_of(const Trial& trial) const {
  if (trial.practice) return rounds_.at(static_cast<std::size_t>(trial.round) - 1);
  for (const CourseBlock& block : blocks_)
    if (plan_.trials[block.begin].block == trial.block) return {block.begin, block.end};
  return {};
}

std::vector<Trial> Course::left_of_block(const Trial& trial) const {
  const Span block = span_of(trial);
  std::vector<Trial> left;
  for (std::size_t i = block.begin; i < block.end; ++i)
    if (open(plan_.trials[i]) && failed_[static_cast<std::size_t>(plan_.trials[i].index)] == 0)
      left.push_back(plan_.trials[i]);
  for (const int index : state_.void_order) {
    const Trial* voided = planned(index);
    if (voided != nullptr && span_of(*voided).begin == block.begin && open(*voided)) left.push_back(*voided);
  }
  return left;
}

// Of left_of_block, without making the list for every trial.
const Trial* Course::first_open(Span block) const {
  bool failed = false;
  for (std::size_t i = block.begin; i < block.end; ++i) {
    const Trial& trial = plan_.trials[i];
    if (!open(trial)) continue;
    if (failed_[static_cast<std::size_t>(trial.index)] == 0) return &trial;
    failed = true;
  }
  if (!failed) return nullptr;
  for (const int index : state_.void_order) {
    const Trial* trial = planned(index);
    if (trial == nullptr) continue;
    const auto place = static_cast<std::size_t>(trial - plan_.trials.data());
    if (place >= block.begin && place < block.end && open(*trial)) return trial;
  }
  return nullptr;
}

const TrialRecord* Course::last_answer(const Trial& next) const {
  if (state_.taken_back || state_.completed.empty()) return nullptr;
  const TrialRecord& last = state_.completed.back();
  const bool reachable = last.trial.practice == next.practice && last.trial.round == next.round;
  return reachable ? &last : nullptr;
}

Step Course::next_step() const {
  if (auto due = left_behind()) return *due;
  if (auto due = opening()) return *due;
  if (auto due = practise()) return *due;
  if (auto due = instruct(Instruction::When::before_main)) return *due;
  if (auto due = plan_.explorations.empty() ? main_part() : free_interaction()) return *due;
  if (auto due = ask({Question::When::after_session, -1, 0})) return *due;
  return step::Done{};
}

// What an interruption left behind, where the session was taken up again.
std::optional<Step> Course::left_behind() const {
  // The block in which the session stood begins anew, in its planned order; what was voided there without an answer
  // comes at its end, as it would have.
  if (state_.redo_due && plan_.explorations.empty()) {
    const auto interrupted = std::find_if(blocks_.begin(), blocks_.end(), [&](const CourseBlock& block) {
      return first_open({block.begin, block.end}) != nullptr;
    });
    if (interrupted != blocks_.end())
      for (const TrialRecord& record : state_.completed)
        if (!record.trial.practice && record.trial.block == plan_.trials[interrupted->begin].block)
          return step::TakeBack{record.trial.index, record.attempt, "block_redone"};
  }
  if (state_.pending && planned(state_.pending->index) != nullptr)
    return step::SettleTrial{state_.pending->index, state_.pending->attempt, state_.redo_due};
  // The last round that was begun, also where its answers were taken back before.
  if (state_.practice_due && protocol_.practice && main_left() > 0) {
    int round = 0;
    for (const Span& one : rounds_)
      for (std::size_t i = one.begin; i < one.end; ++i)
        if (state_.attempts.contains(plan_.trials[i].index)) round = plan_.trials[i].round;
    for (const TrialRecord& record : state_.completed)
      if (record.trial.practice && record.trial.round == round)
        return step::TakeBack{record.trial.index, record.attempt, "practice_again"};
  }
  return std::nullopt;
}

// What comes before the first trial. The checklist each time: a mask may have slipped since.
std::optional<Step> Course::opening() const {
  if (person_ && std::any_of(protocol_.checklist.begin(), protocol_.checklist.end(),
                             [&](const Question& item) { return !state_.checked.contains(item.id); }))
    return step::CheckList{};
  if (auto due = instruct(Instruction::When::before_session)) return due;
  if (person_ && !protocol_.consent.empty() && !state_.consented) return step::AskConsent{};
  return ask({Question::When::before_session, -1, 0});
}

std::optional<Step> Course::instruct(Instruction::When when) const {
  if (!person_) return std::nullopt;
  for (std::size_t i = 0; i < protocol_.instructions.size(); ++i) {
    const Instruction& instruction = protocol_.instructions[i];
    if (instruction.when == when && !state_.instructed.contains(instruction.id))
      return step::Instruct{static_cast<int>(i)};
  }
  return std::nullopt;
}

std::optional<Step> Course::ask(const CoursePage& page) const {
  step::Ask due{page, questions_on(page, protocol_, plan_.conditions)};
  std::erase_if(due.questions, [&](const AskedPlace& asked) {
    const std::string name = asked.condition < 0 ? "" : condition_name(protocol_, asked.condition);
    return state_.answered.contains(question_key(question_of(asked.question, protocol_).id, name, page.after_trial));
  });
  if (due.questions.empty()) return std::nullopt;
  return due;
}

// Rounds until one meets the criterion; the operator may have ended it before.
std::optional<Step> Course::practise() const {
  if (!protocol_.practice || state_.practice_ended) return std::nullopt;
  if (auto due = instruct(Instruction::When::before_practice)) return due;
  for (std::size_t i = 0; i < rounds_.size(); ++i) {
    if (const Trial* trial = first_open(rounds_[i])) return present(*trial);
    const step::EndPractice end = end_of_practice(static_cast<int>(i) + 1);
    if (end.passed || i + 1 == rounds_.size()) return end;
  }
  return std::nullopt;
}

step::EndPractice Course::end_of_practice(int round) const {
  const Span& trials = rounds_.at(static_cast<std::size_t>(round) - 1);
  const int correct = practice_[static_cast<std::size_t>(round)].correct;
  const double share = static_cast<double>(correct) / static_cast<double>(trials.end - trials.begin);
  return {round, share, share >= protocol_.practice->criterion_correct};
}

std::optional<Step> Course::main_part() const {
  for (const CourseBlock& block : blocks_) {
    if (const Trial* trial = first_open({block.begin, block.end})) {
      if (auto due = take_break(break_within_block(main_done_, protocol_), main_done_)) return due;
      return present(*trial);
    }
    if (auto due = after_block(block)) return due;
  }
  return std::nullopt;
}

Step Course::present(const Trial& trial) const {
  if (attempts_used(trial.index) >= protocol_.timeline.max_attempts) return step::GiveUp{resolved(trial)};
  return step::Present{resolved(trial)};
}

std::optional<Step> Course::after_block(const CourseBlock& block) const {
  for (const CoursePage& page : pages_after(block))
    if (auto due = ask(page)) return due;
  return take_break(break_after(block, protocol_), block.planned);
}

std::optional<Step> Course::take_break(const Break* pause, int after_trial) const {
  if (pause == nullptr || state_.breaks_after.contains(after_trial)) return std::nullopt;
  return step::TakeBreak{static_cast<int>(pause - protocol_.breaks.data()), after_trial};
}

std::optional<Step> Course::free_interaction() const {
  for (const ExplorationSlot& slot : plan_.explorations)
    if (state_.exploration.pending == slot.index)
      return step::SettleExploration{slot, next_exploration_attempt(slot.index) - 1};
  for (const CourseBlock& block : blocks_) {
    for (std::size_t i = block.begin; i < block.end; ++i)
      if (!exploration_over(plan_.explorations[i].index))
        return step::Explore{plan_.explorations[i], next_exploration_attempt(plan_.explorations[i].index)};
    if (auto due = after_block(block)) return due;
  }
  return std::nullopt;
}

Step next_step(const Protocol& protocol, const Plan& plan, const SessionState& state, bool person) {
  Course course(protocol, plan, person);
  course.start(state);
  return course.next_step();
}

}  // namespace jnd
