#include "runner/session/session_engine.h"

#include <algorithm>
#include <optional>

#include "runner/session/exploration_block.h"

namespace jnd {

namespace {

constexpr double kAssumedTrialOverhead_s = 4;  // before any trial was timed: reaching, cues and the answer

}  // namespace

SessionEngine::SessionEngine(const SessionParts& parts)
    : parts_(parts),
      protocol_(parts.protocol),
      plan_(parts.plan),
      recorder_(parts),
      conductor_(parts, recorder_),
      progress_(parts.protocol, parts.plan),
      codes_(condition_codes(parts.protocol, parts.plan.seed)) {
  for (const Trial& trial : plan_.trials) blocks_ = std::max(blocks_, trial.block);
}

SessionEnd SessionEngine::run(const SessionState& state, ResumeSteps steps) {
  if (state.ended_for_good) return SessionEnd::closed_early;  // all but closing it was done before
  progress_.start(state);
  try {
    open_session(steps);
    if (protocol_.paradigm == Paradigm::explore) {
      instruct(Instruction::When::before_main);
      run_explorations(
          parts_, recorder_, progress_.state(),
          [this](int condition, int done) { ask(Question::When::after_condition, condition, done); },
          [this](int done, bool last) {
            if (!last) take_breaks(done, false);
          });
    } else {
      run_practice();
      instruct(Instruction::When::before_main);
      say_progress();
      while (!run_main()) {
      }
    }
    ask(Question::When::after_session, -1, 0);
  } catch (const SessionEnds& end) {
    parts_.rig.neutral();
    if (parts_.person)
      recorder_.append(event_kind::kLeft, {{"cause", end.cause}, {"reason", end.reason}, {"for_good", end.for_good}});
    return end.for_good ? SessionEnd::closed_early : SessionEnd::interrupted;
  } catch (...) {
    parts_.rig.neutral();
    throw;
  }
  parts_.rig.neutral();
  return SessionEnd::completed;
}

// What comes before the first trial, and what an interruption left behind.
void SessionEngine::open_session(ResumeSteps steps) {
  if (steps.redo_block) redo_interrupted_block();
  settle_pending(steps.redo_block);
  // Also where the last resume asked for it and it did not come to it.
  if (steps.practice_again || progress_.state().practice_due) practise_again();
  check_list();
  instruct(Instruction::When::before_session);
  consent();
  ask(Question::When::before_session, -1, 0);
}

// A stimulus that was felt and has no answer is presented again, as a new attempt.
void SessionEngine::settle_pending(bool in_its_place) {
  const std::optional<PendingTrial> pending = progress_.state().pending;
  if (!pending) return;
  progress_.state().pending.reset();
  for (const Trial& planned : plan_.trials)
    if (planned.index == pending->index) {
      const Trial trial = progress_.resolved(planned);
      conductor_.log_void(trial, pending->attempt, "interrupted", {}, false, in_its_place);
      progress_.voided(trial, pending->attempt, false, in_its_place);
    }
}

void SessionEngine::take_back(const Trial& trial, int attempt, bool anew, const std::string& reason) {
  conductor_.log_void(trial, attempt, reason, {}, false, anew);
  progress_.forget_answer(trial.index);
  progress_.voided(trial, attempt, false, anew);
}

// The block in which the session stood begins anew, in its planned order; what was voided there without an answer comes
// at its end, as it would have.
void SessionEngine::redo_interrupted_block() {
  for (const std::vector<Trial>& block : main_blocks()) {
    if (progress_.open_trials(block).empty()) continue;
    const std::vector<TrialRecord> completed = progress_.state().completed;
    for (const TrialRecord& record : completed)
      if (!record.trial.practice && record.trial.block == block.front().block)
        take_back(record.trial, record.attempt, true, "block_redone");
    return;
  }
}

void SessionEngine::practise_again() {
  if (!protocol_.practice || progress_.main_left() == 0) return;
  const std::vector<TrialRecord> completed = progress_.state().completed;
  // The last round that was begun, also where its answers were taken back before.
  int round = 0;
  for (const Trial& trial : plan_.trials)
    if (trial.practice && progress_.state().attempts.contains(trial.index)) round = std::max(round, trial.round);
  if (round == 0) return;
  for (const TrialRecord& record : completed)
    if (record.trial.practice && record.trial.round == round)
      take_back(record.trial, record.attempt, true, "practice_again");
  progress_.state().practice_ended = false;
}

void SessionEngine::run_practice() {
  if (!protocol_.practice || progress_.state().practice_ended) return;
  instruct(Instruction::When::before_practice);
  const Practice& practice = *protocol_.practice;
  for (int round = 1; round <= practice.max_rounds; ++round) {
    std::vector<Trial> trials;
    for (const Trial& trial : plan_.trials)
      if (trial.practice && trial.round == round) trials.push_back(trial);
    run_block(trials);
    const bool ended = progress_.state().practice_ended;  // by the operator
    const double share =
        trials.empty() ? 0 : static_cast<double>(progress_.round_correct(round)) / static_cast<double>(trials.size());
    const bool passed = share >= practice.criterion_correct;
    if (!ended && !passed && round < practice.max_rounds) continue;
    recorder_.append(event_kind::kPracticeEnded, {{"rounds", round}, {"share_correct", share}, {"passed", passed}});
    progress_.state().practice_ended = true;
    parts_.view.practice_over(round, share, passed);
    return;
  }
}

std::vector<std::vector<Trial>> SessionEngine::main_blocks() const {
  std::vector<std::vector<Trial>> blocks;
  for (const Trial& trial : plan_.trials) {
    if (trial.practice) continue;
    if (blocks.empty() || blocks.back().front().block != trial.block) blocks.emplace_back();
    blocks.back().push_back(trial);
  }
  return blocks;
}

bool SessionEngine::run_main() {
  int planned = 0;  // how many main trials the plan has had by the end of this block: the place that keys questions and
                    // breaks, the same however many trials were repeated or given up
  const std::vector<std::vector<Trial>> blocks = main_blocks();
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const std::vector<Trial>& block = blocks[i];
    const bool last = i + 1 == blocks.size();
    const bool series_over = last || blocks[i + 1].front().series != block.front().series;
    if (run_block(block) == BlockEnd::reordered) return false;
    planned += static_cast<int>(block.size());
    if (protocol_.design.arrangement == Arrangement::blocked)
      ask(Question::When::after_condition, block.back().condition, planned);
    if (series_over) ask(Question::When::after_series, -1, planned);
    if (!last) take_breaks(planned, series_over);
  }
  return true;
}

SessionEngine::BlockEnd SessionEngine::run_block(const std::vector<Trial>& block) {
  std::deque<Trial> queue = progress_.open_trials(block);
  // A session that was killed between an answer and the break that was due.
  if (!queue.empty() && !queue.front().practice) take_breaks_within_block();
  while (!queue.empty()) {
    const Trial planned = queue.front();
    const Trial trial = progress_.resolved(planned);
    const int used = progress_.attempts_used(trial.index);
    if (used >= protocol_.timeline.max_attempts) {
      give_up(trial);
      queue.pop_front();
      continue;
    }
    const TrialOutline outline = outline_of(trial);
    BlockEnd end = BlockEnd::over;
    if (!ready(trial, outline, {queue.begin(), queue.end()}, end)) {
      if (end == BlockEnd::reordered) return end;
      queue = progress_.open_trials(block);
      continue;
    }
    queue.pop_front();
    const TrialConductor::Outcome outcome = conductor_.conduct(trial, outline, used, after_trial());
    if (outcome.answered) {
      progress_.answered(outcome.record);
      seconds_in_trials_ += outcome.record.duration_s;
      ++trials_timed_;
      say_progress();
    } else {
      progress_.voided(trial, outline.attempt, outcome.counts);
      queue.push_back(planned);
    }
    // A track that has its reversals leaves the slots that were planned for it.
    std::erase_if(queue, [&](const Trial& left) { return progress_.over(left); });
    if (!trial.practice && !queue.empty()) take_breaks_within_block();
  }
  return BlockEnd::over;
}

bool SessionEngine::ready(const Trial& next, const TrialOutline& outline, const std::vector<Trial>& left,
                          BlockEnd& end) {
  for (;;) {
    const OperatorRequest wish = settle(parts_, recorder_, after_trial(), [&] {
      (void)conductor_.rested();  // a note or a pause leaves its rest
      return parts_.view.ready(outline);
    });
    heed_interrupts(parts_, recorder_, after_trial());
    if (wish.request == Request::go_on) {
      // However soon the operator goes on, the time between trials passes. A stop that is still latched is one that
      // nobody clears, and ends the session when something is to be presented.
      if (parts_.rig.stop.latched() || conductor_.rested()) return true;
      continue;
    }
    if (wish.request == Request::take_break) break_on_request(wish.text);
    if (wish.request == Request::end_block) {
      end_block(left, wish.text);
      return false;
    }
    const TrialRecord* last = progress_.last_answer(next);
    if (wish.request == Request::void_last && last != nullptr) {
      if (last->trial.block != next.block) end = BlockEnd::reordered;
      take_back_last(TrialRecord(*last), wish.text);
      return false;
    }
  }
}

void SessionEngine::take_back_last(const TrialRecord& last, const std::string& words) {
  conductor_.log_void(last.trial, last.attempt, "taken_back", words, true);
  progress_.forget_last_answer();
  progress_.voided(last.trial, last.attempt, true);
  say_progress();
  parts_.view.took_back(progress_.attempts_used(last.trial.index) < protocol_.timeline.max_attempts);
}

// The rest of a block, or of practice, is given up in one event.
void SessionEngine::end_block(const std::vector<Trial>& left, const std::string& reason) {
  nlohmann::ordered_json trials = nlohmann::ordered_json::array();
  for (const Trial& trial : left) trials.push_back(trial.index);
  const Trial& next = left.front();
  recorder_.append(event_kind::kBlockEnded, {{"block", next.block},
                                             {"practice", next.practice},
                                             {"round", next.round},
                                             {"reason", reason},
                                             {"trials", std::move(trials)}});
  for (const Trial& trial : left) progress_.given_up(trial);
  if (next.practice) progress_.state().practice_ended = true;
  say_progress();
}

// Attempts used up: the cell stays short, and the log says so.
void SessionEngine::give_up(const Trial& trial) {
  recorder_.append(event_kind::kTrialsShort,
                   voided_body(protocol_, trial, progress_.attempts_used(trial.index), "attempts used up"));
  progress_.given_up(trial);
}

void SessionEngine::take_breaks_within_block() {
  const int done = progress_.main_done();
  for (const Break& pause : protocol_.breaks)
    if (pause.after == Break::After::trials && done > 0 && done % pause.trials == 0) take_break(pause, done);
}

void SessionEngine::take_breaks(int planned, bool series_over) {
  for (const Break& pause : protocol_.breaks) {
    const bool due = pause.after == Break::After::block || (pause.after == Break::After::series && series_over) ||
                     (pause.after == Break::After::trials && planned % pause.trials == 0);
    if (due) {
      take_break(pause, planned);
      return;  // one break at one place, the first that the protocol names
    }
  }
}

void SessionEngine::take_break(const Break& pause, int after_trial) {
  if (progress_.state().breaks_after.contains(after_trial)) return;
  heed_interrupts(parts_, recorder_, after_trial);
  const std::int64_t began = parts_.clock.now_ns();
  parts_.view.break_begins(pause, false);
  settle(parts_, recorder_, after_trial, [&] { return parts_.view.break_over(pause); });
  const std::int64_t least = began + static_cast<std::int64_t>(pause.duration_s * 1e9);
  wait_out(parts_, recorder_, least, after_trial);
  recorder_.append(
      event_kind::kBreakTaken,
      {{"after_trial", after_trial}, {"duration_s", static_cast<double>(parts_.clock.now_ns() - began) * 1e-9}});
  progress_.state().breaks_after.insert(after_trial);
}

// A break that the protocol does not ask for; one that was due at the same place is taken with it.
void SessionEngine::break_on_request(const std::string& reason) {
  Break pause;
  pause.duration_s = 0;
  const std::int64_t began = parts_.clock.now_ns();
  parts_.view.break_begins(pause, true);
  settle(parts_, recorder_, after_trial(), [&] { return parts_.view.break_over(pause); });
  recorder_.append(event_kind::kBreakTaken, {{"after_trial", after_trial()},
                                             {"duration_s", static_cast<double>(parts_.clock.now_ns() - began) * 1e-9},
                                             {"on_request", true},
                                             {"reason", reason}});
  progress_.state().breaks_after.insert(after_trial());
}

void SessionEngine::say_progress() {
  if (parts_.person) parts_.view.progress(progress_.by_condition(codes_));
}

TrialOutline SessionEngine::outline_of(const Trial& trial) const {
  const int left = progress_.main_left();
  TrialOutline outline;
  outline.practice = trial.practice;
  outline.round = trial.round;
  outline.plan_number = trial.index;
  outline.attempt = progress_.next_attempt(trial.index);
  outline.block = trial.block;
  outline.blocks = blocks_;
  // None in practice: it takes the conditions in the protocol's own order, which would name the letters.
  if (!trial.practice) outline.condition_code = codes_[static_cast<std::size_t>(trial.condition)];
  if (trial.practice) {
    outline.total = protocol_.practice->trials;
    outline.number = 1 + progress_.round_answered(trial.round);
  } else {
    outline.number = progress_.main_done() + 1;
    outline.total = progress_.main_done() + left;
    outline.at_most = protocol_.design.procedure && protocol_.design.procedure->reversals > 0;
  }
  const Timeline& timeline = protocol_.timeline;
  const double pace = trials_timed_ > 0 ? seconds_in_trials_ / trials_timed_
                                        : 2 * timeline.explore_s + timeline.gap_s + kAssumedTrialOverhead_s;
  outline.time_left_s = left * (pace + timeline.between_trials_s);
  outline.can_void_last = progress_.last_answer(trial) != nullptr;
  return outline;
}

// What a session asks and tells people around its trials: checklist, instructions, consent, pages of questions.

// A page is answered as a whole. Ctrl-C: a pause, then the page again.
Replies SessionEngine::replies_to(const std::vector<AskedQuestion>& page) {
  for (;;) {
    heed_interrupts(parts_, recorder_, after_trial());
    const std::optional<Replies> replies = parts_.responder.reply_all(page);
    if (replies && !parts_.interrupts.end) return *replies;
    heed_interrupts(parts_, recorder_, after_trial());
    const OperatorRequest wish = parts_.view.meanwhile();
    if (!parts_.person || wish.request != Request::go_on)
      throw SessionEnds{wish.request == Request::end_for_good, "operator", wish.text};
  }
}

// Asked each time: a mask may have slipped since.
void SessionEngine::check_list() {
  if (!parts_.person || protocol_.checklist.empty()) return;
  std::vector<AskedQuestion> page;
  for (const Question& item : protocol_.checklist) page.push_back({item, -1});
  const Replies replies = replies_to(page);
  for (std::size_t i = 0; i < page.size(); ++i) {
    const std::optional<std::string>& answer = replies[i];
    recorder_.append(event_kind::kChecklist,
                     {{"question", page[i].question.id},
                      {"text", page[i].question.text},
                      {"answer", answer ? nlohmann::ordered_json(*answer) : nlohmann::ordered_json(nullptr)}});
  }
}

void SessionEngine::instruct(Instruction::When when) {
  if (!parts_.person) return;
  for (const Instruction& instruction : protocol_.instructions) {
    if (instruction.when != when || progress_.state().instructed.contains(instruction.id)) continue;
    settle(parts_, recorder_, after_trial(), [&] { return parts_.view.instruct(instruction); });
    recorder_.append(event_kind::kInstructed, {{"id", instruction.id}, {"language", protocol_.language}});
    progress_.state().instructed.insert(instruction.id);
  }
}

void SessionEngine::consent() {
  if (!parts_.person || protocol_.consent.empty() || progress_.state().consented) return;
  std::optional<bool> given;
  while (!given) {
    heed_interrupts(parts_, recorder_, after_trial());
    given = parts_.view.consent(protocol_.consent);
  }
  nlohmann::ordered_json body = {{"language", protocol_.language}, {"text", protocol_.consent}, {"by", "operator"}};
  if (!*given) body["refused"] = true;
  recorder_.append(event_kind::kConsent, body);
  if (!*given) throw SessionEnds{true, "no consent", {}};
  progress_.state().consented = true;
}

// One page: it is answered as a whole, and saved when it is done.
void SessionEngine::ask(Question::When when, int condition, int after_trial) {
  const auto name_of = [&](int place) {
    return place < 0 ? std::string() : protocol_.conditions[static_cast<std::size_t>(place)].name;
  };
  std::vector<AskedQuestion> page;
  const auto add = [&](const Question& question, int place) {
    if (!progress_.state().answered.contains(question_key(question.id, name_of(place), after_trial)))
      page.push_back({question, place});
  };
  for (const Question& question : protocol_.questions) {
    if (question.when != when) continue;
    if (question.per_condition) {
      for (int i = 0; i < static_cast<int>(protocol_.conditions.size()); ++i) add(question, i);
    } else {
      add(question, condition);
    }
  }
  if (page.empty()) return;
  const Replies replies = replies_to(page);
  for (std::size_t i = 0; i < page.size(); ++i) {
    const std::string name = name_of(page[i].condition);
    recorder_.append(event_kind::kQuestionAnswered, question_body(page[i].question, name, replies[i], after_trial));
    progress_.state().answered.insert(question_key(page[i].question.id, name, after_trial));
  }
}

}  // namespace jnd
