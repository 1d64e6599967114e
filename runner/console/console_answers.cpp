// The participant's side of the console: answers to trials, with their response times, and pages of questions.
#include <algorithm>
#include <cmath>
#include <variant>

#include <fmt/format.h>

#include "devices/hid/buttons/button_box.h"
#include "protocols/input/look_alikes.h"
#include "protocols/input/number_from.h"
#include "runner/console/session_console.h"
#include "runner/terminal/terminal.h"
#include "runner/words/words.h"

namespace jnd {

namespace {

// The rig's buttons answer no question that is over.
class WithdrawnAtEnd {
 public:
  explicit WithdrawnAtEnd(RigButtons* buttons) noexcept : buttons_(buttons) {}
  ~WithdrawnAtEnd() {
    if (buttons_ != nullptr) buttons_->withdraw();
  }
  WithdrawnAtEnd(const WithdrawnAtEnd&) = delete;
  WithdrawnAtEnd& operator=(const WithdrawnAtEnd&) = delete;

 private:
  RigButtons* buttons_;
};

}  // namespace

Answer SessionConsole::answer_of(GivenAnswer given, EnteredBy who, std::int64_t pressed_ns) const {
  // The time of the press, not of its being noticed here; the session's clock may have skipped what was waiting.
  const std::int64_t age_ns = SteadyClock().now_ns() - pressed_ns;
  const std::int64_t response_ns = std::max<std::int64_t>(0, clock_.now_ns() - cue_shown_ns_ - age_ns);
  return Answer{given.said, given.sureness, std::nullopt, who, static_cast<double>(response_ns) * 1e-9};
}

// What is heard from now on is for the next ready(). An answer counts only in time; the look at the clock was before
// the wait for it.
std::optional<Answer> SessionConsole::question_over(const std::optional<Answer>& answer, double time_out_s) {
  display_->working_keys(between_trials_keys(protocol_.task).hints());
  return answer && answer->response_time_s <= time_out_s ? answer : std::nullopt;
}

SessionConsole::ButtonReply SessionConsole::hear_buttons() {
  ButtonReply reply;
  if (options_.rig_buttons != nullptr) {
    if (const auto pressed = options_.rig_buttons->pressed()) {
      const AnswerChoice& chosen = protocol_.task.answers[pressed->place];
      reply.answer = answer_of({chosen.said, chosen.sureness}, EnteredBy::participant, pressed->time_ns);
      return reply;
    }
  }
  if (options_.buttons == nullptr) return reply;
  tell_events();
  const ButtonsHeard heard = options_.buttons->hear();
  reply.pending = heard.pending;
  reply.stopped = heard.stopped;
  if (heard.trouble == AnswerTrouble::two_at_once)
    display_->explain(Tone::warning, tr("both buttons at once: no answer. Let go of both, then press one"));
  if (heard.trouble == AnswerTrouble::held)
    display_->explain(Tone::warning, tr("a button was down already: let go of it, then press it again"));
  if (heard.answer) reply.answer = answer_of({heard.answer->said, 0}, EnteredBy::participant, heard.answer->time_ns);
  return reply;
}

void SessionConsole::tell_events() {
  if (options_.buttons == nullptr) return;
  for (const BoxEvent& event : options_.buttons->take_events())
    display_->tell(event.warning ? Tone::warning : Tone::quiet, event.text);
}

std::optional<Answer> SessionConsole::judge_number(const TrialQuestion& question) {
  const TaskSpec& task = protocol_.task;
  while (!interrupted()) {
    const std::optional<std::string> line = keys_.line(tr("Number (empty: no answer)"));
    if (keys_.ended()) decided_ = OperatorRequest{Request::end_for_now, {}};
    const std::string_view typed = line ? without_blanks(*line) : std::string_view();
    if (typed.empty()) return std::nullopt;
    const std::optional<double> number = number_from<double>(typed);
    if (!number || !std::isfinite(*number) || *number < task.number_min || *number > task.number_max) {
      display_->explain(Tone::warning, tr("not a number from {:g} to {:g}: type it once more, such as 12.5",
                                          task.number_min, task.number_max));
      continue;
    }
    Answer answer = answer_of({-1, 0}, options_.entered_by, SteadyClock().now_ns());
    answer.number = *number;
    return question_over(answer, question.time_out_s);
  }
  return std::nullopt;
}

// The latch is set: no answer counts. It is on the screen before what it ends is written down.
std::optional<Answer> SessionConsole::stopped_unanswered() {
  keys_.look_at_stop();
  return std::nullopt;
}

std::optional<Answer> SessionConsole::judge(const TrialQuestion& question) {
  if (protocol_.task.answers.empty()) return judge_number(question);
  const WithdrawnAtEnd asking(options_.rig_buttons);
  const KeyMap& keys = question_keys_;
  Scene scene;
  scene.keys = keys.hints();
  display_->scene(scene);
  while (!keys_.pause_asked()) {
    if (keys_.ended()) {
      decided_ = OperatorRequest{Request::end_for_now, {}};
      return std::nullopt;
    }
    const ButtonReply buttons = hear_buttons();
    if (buttons.answer) return question_over(buttons.answer, question.time_out_s);
    if (buttons.stopped || keys_.stopped()) return stopped_unanswered();
    const double gone_s = static_cast<double>(clock_.now_ns() - cue_shown_ns_) * 1e-9;
    if (!buttons.pending && gone_s > question.time_out_s) return question_over(std::nullopt, question.time_out_s);
    display_->phase(SessionPhases::question(gone_s, question.time_out_s));
    const std::optional<Key> key = keys_.next();
    if (!key || display_->scroll(key->name)) continue;
    const std::optional<KeyBinding> binding = keys.binding_of(*key);
    if (!binding) {
      explain(keys, *key);
      continue;
    }
    if (const GivenAnswer* const given = std::get_if<GivenAnswer>(&binding->meaning))
      return question_over(answer_of(*given, options_.entered_by, key->time_ns), question.time_out_s);
    if (binding->asks(Request::stopped)) return stopped_unanswered();
    if (binding->asks(Request::pause) || binding->asks(Request::note)) {
      note_requests({*key}, keys);
    } else {
      decided_ = request_of(*binding, keys);
      if (decided_) return std::nullopt;
      if (!keys_.ended()) display_->keys_again();
    }
  }
  return std::nullopt;
}

// A key that was pressed before the first contact, or is held down since before, does not end the interval.
bool SessionConsole::enough(const IntervalId& /*id*/, double /*elapsed_s*/) {
  if (!keys_.has_keyboard() || interrupted()) return false;
  const KeyMap keys = presentation_keys(protocol_);
  if (!std::exchange(asks_enough_, true)) note_in_trial(keys_.prompt());
  const std::optional<Key> key = keys_.next();
  if (!key || display_->scroll(key->name)) return false;
  if (const auto binding = keys.binding_of(*key); binding && binding->asks(Request::go_on)) return true;
  note_in_trial({*key});
  return false;
}

std::optional<std::string> SessionConsole::reply(const Question& question, int condition) {
  const std::optional<Replies> replies = reply_all({{question, condition}});
  return replies ? replies->front() : std::nullopt;
}

std::optional<Replies> SessionConsole::reply_all(const std::vector<AskedQuestion>& page) {
  if (page.empty()) return Replies{};
  if (!keys_.has_keyboard()) return std::nullopt;
  std::vector<QuestionnairePage::Item> items;
  std::vector<std::string> ids;
  for (const AskedQuestion& asked : page) {
    QuestionnairePage::Item item;
    item.question = &asked.question;
    // Right after a condition its name would tell which letter it has.
    const bool gives_away = protocol_.blinded && asked.question.when == Question::When::after_condition;
    if (asked.condition >= 0 && !gives_away)
      item.about = protocol_.conditions[static_cast<std::size_t>(asked.condition)].label;
    items.push_back(item);
    ids.push_back(fmt::format("{} {}", asked.question.id, asked.condition));
  }
  if (ids == unfinished_ids_)
    for (std::size_t i = 0; i < items.size(); ++i) items[i].typed = unfinished_[i];
  // What is written to a pipe cannot be looked through once more.
  QuestionnairePage questions(std::move(items), keyboard_->is_terminal());
  display_->phase({.word = tr("QUESTIONS"), .holds = true, .shade = Shade::question});
  if (options_.alerts) display_->alert();
  const bool done = display_->by_lines() ? ask_by_lines(questions) : ask_by_keys(questions);
  display_->log(done ? tr("questions answered") : tr("questions left without answers"));
  unfinished_.clear();
  unfinished_ids_.clear();
  if (done) return questions.replies();
  for (const QuestionnairePage::Item& item : questions.items()) unfinished_.push_back(item.typed);
  unfinished_ids_ = ids;
  return std::nullopt;
}

// Escape asks whether the session is to end.
bool SessionConsole::leaves_page() {
  decided_ = ask_end();
  return decided_.has_value();
}

bool SessionConsole::ask_by_keys(QuestionnairePage& page) {
  const TypingText typing(*keyboard_);
  keys_.prompt();
  bool left = false, changed = true;
  while (!left) {
    if (changed) display_->page(page);
    changed = true;
    std::optional<Key> key;
    while (!key && !interrupted()) key = keys_.next(true);
    if (!key) break;
    // Where no text is typed the question mark is a key too.
    const bool text = !page.reviewing() && page.items()[page.at()].question->kind == Question::Kind::text;
    if (display_->help(false) || (!text && key->is(U'?') && display_->help(true))) {
      changed = false;
      continue;
    }
    if ((key->is(KeyName::page_down) || key->is(KeyName::page_up)) && display_->scroll(key->name)) continue;
    if (page.answers(*key) && still_to_read()) {
      changed = false;  // so that what is told stays
      continue;
    }
    const std::size_t before = page.at();
    const QuestionnairePage::State state = page.press(*key);
    if (state == QuestionnairePage::State::committed) {
      display_->page_done();
      return true;
    }
    if (state == QuestionnairePage::State::leaving) {
      left = leaves_page();
    }
    if (page.at() != before) keys_.prompt();  // Enter held down does not run through the page
  }
  if (keys_.ended()) decided_ = OperatorRequest{Request::end_for_now, {}};
  display_->page_done();
  return false;
}

bool SessionConsole::ask_by_lines(QuestionnairePage& page) {
  bool shown = false;
  std::size_t at = 0;
  while (!interrupted()) {
    if (!shown || page.at() != at) display_->page(page);
    shown = true;
    at = page.at();
    const std::optional<std::string> line = keys_.line("");
    if (!line) {
      if (interrupted()) break;
      if (leaves_page()) return false;
      shown = false;
      continue;
    }
    if (page.enter(*line) == QuestionnairePage::State::committed) return true;
    if (!page.mistake().empty()) display_->explain(Tone::quiet, page.mistake());
  }
  if (keys_.ended()) decided_ = OperatorRequest{Request::end_for_now, {}};
  return false;
}

}  // namespace jnd
