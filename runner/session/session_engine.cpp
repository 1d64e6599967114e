#include "runner/session/session_engine.h"

#include <algorithm>
#include <optional>
#include <variant>

#include "data/log/event_body.h"
#include "protocols/condition_words.h"
#include "protocols/course/duration.h"
#include "protocols/course/prescription.h"
#include "protocols/planning/adaptive_run.h"
#include "runner/session/rig_connections.h"

namespace jnd {

namespace {

// Answered trials from one word about the rig to the next.
constexpr int kTrialsPerWord = 10;

// Nothing but the main part, and what comes behind it, is left.
bool opens_main(const Step& step) {
  const auto* page = std::get_if<step::Ask>(&step);
  const auto* trial = std::get_if<step::Present>(&step);
  const auto* short_of = std::get_if<step::GiveUp>(&step);
  return (page != nullptr && page->page.when != Question::When::before_session) ||
         (trial != nullptr && !trial->trial.practice) || (short_of != nullptr && !short_of->trial.practice) ||
         std::holds_alternative<step::TakeBreak>(step) || std::holds_alternative<step::Done>(step);
}

}  // namespace

SessionEngine::SessionEngine(const SessionParts& parts)
    : parts_(parts),
      protocol_(parts.protocol),
      plan_(parts.plan),
      course_(parts.protocol, parts.plan, parts.person),
      recorder_(parts, course_),
      explorations_(parts, recorder_),
      conductor_(parts, recorder_),
      codes_(condition_codes(parts.protocol, parts.plan.seed)) {
  for (const Trial& trial : plan_.trials) blocks_ = std::max(blocks_, trial.block);
}

SessionEnd SessionEngine::run(const SessionState& state, ResumeSteps steps) {
  if (state.ended_for_good) return SessionEnd::closed_early;  // all but closing it was done before
  course_.start(state);
  course_.apply(SessionResumed{state.boot_id, steps.redo_block, steps.practice_again});
  try {
    go_through();
  } catch (const SessionEnds& end) {
    parts_.rig.neutral();
    if (parts_.person)
      recorder_.record(SessionLeft{end.for_good},
                       {{"cause", end.cause}, {"reason", end.reason}, {"for_good", end.for_good}});
    return end.for_good ? SessionEnd::closed_early : SessionEnd::interrupted;
  } catch (...) {
    parts_.rig.neutral();
    throw;
  }
  parts_.rig.neutral();
  return SessionEnd::completed;
}

void SessionEngine::go_through() {
  bool in_main = !parts_.plan.explorations.empty();
  for (;;) {
    const Step step = course_.next_step();
    if (!in_main && opens_main(step)) {
      in_main = true;
      say_progress();
    }
    if (std::holds_alternative<step::Done>(step)) return;
    if (parts_.person) parts_.view.time_left(time_left_s());
    std::visit([&](const auto& due) { carry_out(due); }, step);
  }
}

void SessionEngine::carry_out(const step::TakeBack& due) {
  const std::vector<TrialRecord>& completed = course_.state().completed;
  const auto record = std::find_if(completed.begin(), completed.end(), [&](const TrialRecord& one) {
    return one.trial.index == due.index && one.attempt == due.attempt;
  });
  conductor_.log_void(Trial(record->trial), due.attempt, std::string(due.reason), {}, false, true);
}

void SessionEngine::carry_out(const step::SettleTrial& due) {
  conductor_.log_void(course_.resolved(*course_.planned(due.index)), due.attempt, "interrupted", {}, false, due.anew);
}

void SessionEngine::carry_out(const step::Present& due) {
  // What went missing is told now, not when the operator has called the participant to order.
  await_rig(parts_, recorder_, after_trial());
  const TrialOutline outline = outline_of(due.trial);
  if (!ready(due.trial, outline)) return;
  const std::optional<double> took_s = conductor_.conduct(due.trial, outline);
  if (!took_s) return;
  seconds_in_trials_ += *took_s;
  ++trials_timed_;
  say_progress();
  if (trials_timed_ % kTrialsPerWord != 0) return;
  if (const Deliveries deliveries = deliveries_of(course_.state().completed, protocol_); deliveries.off > 0)
    parts_.view.not_as_asked(deliveries);
}

bool SessionEngine::ready(const Trial& next, const TrialOutline& outline) {
  for (;;) {
    const OperatorRequest request = settle(parts_, recorder_, after_trial(), [&] {
      conductor_.get_ready(next, outline);
      (void)conductor_.rested();  // a note or a pause leaves its rest
      return parts_.view.ready(outline);
    });
    handle_interrupts(parts_, recorder_, after_trial());
    if (request.kind == Request::go_on) {
      // However soon the operator goes on, the time between trials passes. A stop that is still latched is one that
      // was not cleared, and ends the session when something is to be presented.
      if (parts_.rig.stop.latched() || conductor_.rested()) return true;
      continue;
    }
    if (request.kind == Request::take_break) break_on_request(request.text);
    if (request.kind == Request::end_block) {
      end_block(next, request.text);
      return false;
    }
    const TrialRecord* last = course_.last_answer(next);
    if (request.kind == Request::void_last && last != nullptr) {
      take_back_last(TrialRecord(*last), request.text);
      return false;
    }
  }
}

void SessionEngine::take_back_last(const TrialRecord& last, const std::string& words) {
  conductor_.log_void(last.trial, last.attempt, std::string(kTakenBack), words, true);
  say_progress();
  parts_.view.took_back(course_.attempts_used(last.trial.index) < protocol_.timeline.max_attempts);
}

// The rest of a block, or of practice, is given up in one event.
void SessionEngine::end_block(const Trial& next, const std::string& reason) {
  BlockEnded event{{}, next.practice};
  for (const Trial& trial : course_.left_of_block(next)) event.trials.push_back(trial.index);
  recorder_.record(event, {{"block", next.block},
                           {"practice", next.practice},
                           {"round", next.round},
                           {"reason", reason},
                           {"trials", event.trials}});
  say_progress();
  if (next.practice) carry_out(course_.end_of_practice(next.round));
}

// Attempts used up: the cell stays short, and the log says so.
void SessionEngine::carry_out(const step::GiveUp& due) {
  recorder_.record(TrialGivenUp{due.trial.index},
                   voided_body(protocol_, due.trial, course_.attempts_used(due.trial.index), "attempts used up"));
}

void SessionEngine::carry_out(const step::EndPractice& due) {
  recorder_.record(PracticeEnded{},
                   {{"rounds", due.round}, {"share_correct", due.share_correct}, {"passed", due.passed}});
  parts_.view.practice_over(due.round, due.share_correct, due.passed);
}

void SessionEngine::carry_out(const step::TakeBreak& due) {
  const Break& pause = protocol_.breaks[static_cast<std::size_t>(due.place)];
  handle_interrupts(parts_, recorder_, due.after_trial);
  const std::int64_t began = parts_.clock.now_ns();
  parts_.view.break_begins(pause, false);
  settle(parts_, recorder_, due.after_trial, [&] { return parts_.view.break_over(pause); });
  const std::int64_t least = began + static_cast<std::int64_t>(pause.duration_s * 1e9);
  wait_out(parts_, recorder_, least, due.after_trial);
  recorder_.record(
      BreakTaken{due.after_trial},
      {{"after_trial", due.after_trial}, {"duration_s", static_cast<double>(parts_.clock.now_ns() - began) * 1e-9}});
}

// A break that the protocol does not ask for; one that was due at the same place is taken with it.
void SessionEngine::break_on_request(const std::string& reason) {
  Break pause;
  pause.duration_s = 0;
  const std::int64_t began = parts_.clock.now_ns();
  parts_.view.break_begins(pause, true);
  settle(parts_, recorder_, after_trial(), [&] { return parts_.view.break_over(pause); });
  recorder_.record(BreakTaken{after_trial()},
                   {{"after_trial", after_trial()},
                    {"duration_s", static_cast<double>(parts_.clock.now_ns() - began) * 1e-9},
                    {"on_request", true},
                    {"reason", reason}});
}

void SessionEngine::say_progress() {
  if (parts_.person) parts_.view.progress(by_condition());
}

std::vector<ConditionProgress> SessionEngine::by_condition() const {
  std::vector<ConditionProgress> progress(codes_.size());
  for (std::size_t i = 0; i < codes_.size(); ++i) progress[i].code = codes_[i];
  for (const Trial& trial : plan_.trials) {
    if (trial.practice) continue;
    ConditionProgress& condition = progress[static_cast<std::size_t>(trial.condition)];
    const bool done = course_.finished(trial.index);
    condition.done += done ? 1 : 0;
    condition.total += done || !course_.over(trial) ? 1 : 0;
  }
  // Of the conditions that the participant gets.
  std::vector<ConditionProgress> own;
  for (const int condition : parts_.plan.conditions) own.push_back(progress[static_cast<std::size_t>(condition)]);
  progress = std::move(own);
  std::sort(progress.begin(), progress.end(),
            [](const ConditionProgress& a, const ConditionProgress& b) { return a.code < b.code; });
  return progress;
}

// At the pace of all trials so far: that of a single one, or of the coming ones, could tell what they present.
double SessionEngine::time_left_s() const {
  // Some trials at the protocol's own pace stand beside those that were: a first one that takes long says little.
  constexpr int kAsExpected = 4;
  std::optional<double> trial_s;
  if (trials_timed_ > 0)
    trial_s = (seconds_in_trials_ + trials_timed_ * protocol_.timeline.between_trials_s +
               kAsExpected * expected_trial_s(protocol_)) /
              (trials_timed_ + kAsExpected);
  return expected_left_s(protocol_, plan_, course_, trial_s);
}

TrialOutline SessionEngine::outline_of(const Trial& trial) const {
  const int left = course_.main_left();
  TrialOutline outline;
  outline.practice = trial.practice;
  outline.round = trial.round;
  outline.plan_number = trial.index;
  outline.attempt = course_.next_attempt(trial.index);
  outline.block = trial.block;
  outline.blocks = blocks_;
  // None in practice: it takes the conditions in the protocol's own order, which would name the letters.
  if (!trial.practice) outline.condition_code = codes_[static_cast<std::size_t>(trial.condition)];
  if (trial.practice) {
    outline.total = protocol_.practice->trials;
    outline.number = 1 + course_.round_answered(trial.round);
  } else {
    outline.number = course_.main_done() + 1;
    outline.total = course_.main_done() + left;
    outline.at_most = can_end_early(protocol_);
  }
  const Condition& condition = protocol_.conditions[static_cast<std::size_t>(trial.condition)];
  if (const Prescription* const prescription = prescription_of(protocol_, condition)) {
    outline.prescribed = prescription->say;
    outline.pace_hz = prescription->pace_hz;
  }
  outline.time_left_s = time_left_s();
  outline.can_void_last = course_.last_answer(trial) != nullptr;
  return outline;
}

// What a session asks and tells people around its trials: checklist, instructions, consent, pages of questions.

// A page is answered as a whole. Ctrl-C: a pause, then the page again.
Replies SessionEngine::replies_to(const std::vector<AskedQuestion>& page) {
  for (;;) {
    handle_interrupts(parts_, recorder_, after_trial());
    const std::optional<Replies> replies = parts_.responder.reply_all(page);
    if (replies && !parts_.interrupts.end) return *replies;
    handle_interrupts(parts_, recorder_, after_trial());
    const OperatorRequest request = parts_.view.meanwhile();
    if (!parts_.person || request.kind != Request::go_on)
      throw SessionEnds{request.kind == Request::end_for_good, "operator", request.text};
  }
}

void SessionEngine::carry_out(const step::CheckList&) {
  std::vector<AskedQuestion> page;
  for (const Question& item : protocol_.checklist) page.push_back({item, -1});
  const Replies replies = replies_to(page);
  for (std::size_t i = 0; i < page.size(); ++i) {
    const std::optional<std::string>& answer = replies[i];
    recorder_.record(ItemChecked{page[i].question.id},
                     {{"question", page[i].question.id},
                      {"text", page[i].question.text},
                      {"answer", answer ? nlohmann::ordered_json(*answer) : nlohmann::ordered_json(nullptr)}});
  }
}

void SessionEngine::carry_out(const step::Instruct& due) {
  const Instruction& instruction = protocol_.instructions[static_cast<std::size_t>(due.instruction)];
  settle(parts_, recorder_, after_trial(), [&] { return parts_.view.instruct(instruction); });
  recorder_.record(InstructionShown{instruction.id}, {{"id", instruction.id}, {"language", protocol_.language}});
}

void SessionEngine::carry_out(const step::AskConsent&) {
  std::optional<bool> given;
  while (!given) {
    handle_interrupts(parts_, recorder_, after_trial());
    given = parts_.view.consent(protocol_.consent);
  }
  nlohmann::ordered_json body = {{"language", protocol_.language}, {"text", protocol_.consent}, {"by", "operator"}};
  if (!*given) body["refused"] = true;
  recorder_.record(ConsentAsked{*given}, body);
  if (!*given) throw SessionEnds{true, "no consent", {}};
}

// One page: it is answered as a whole, and saved when it is done.
void SessionEngine::carry_out(const step::Ask& due) {
  std::vector<AskedQuestion> page;
  for (const AskedPlace& asked : due.questions)
    page.push_back({question_of(asked.question, protocol_), asked.condition});
  const Replies replies = replies_to(page);
  for (std::size_t i = 0; i < page.size(); ++i) {
    const std::string name = page[i].condition < 0 ? "" : condition_name(protocol_, page[i].condition);
    const int after_trial = due.page.after_trial;
    recorder_.record(QuestionAnswered{question_key(page[i].question.id, name, after_trial)},
                     question_body(page[i].question, name, replies[i], after_trial));
  }
}

}  // namespace jnd
