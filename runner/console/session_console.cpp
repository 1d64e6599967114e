#include "runner/console/session_console.h"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

#include "devices/hid/buttons/button_box.h"
#include "protocols/course/prescription.h"
#include "protocols/tasks/task.h"
#include "runner/console/session_summary.h"
#include "runner/console/session_words.h"
#include "runner/session/session_listener.h"
#include "runner/terminal/terminal.h"
#include "runner/words/words.h"

namespace jnd {

namespace {

constexpr double kLook_s = 0.02;    // how often a countdown looks at the keys
constexpr double kCounted_s = 3.0;  // a wait between trials of so long is counted down

bool asks_to_repeat(const KeyBinding& key) noexcept {
  return key.asks(Request::repeat_trial);
}

// A stop is seen to for as long as it lives, or what is asked comes before that.
class SeeingToStop {
 public:
  explicit SeeingToStop(PromptKeys& keys) noexcept : keys_(keys), before_(keys.see_to_stop(true)) {}
  ~SeeingToStop() { keys_.see_to_stop(before_); }
  SeeingToStop(const SeeingToStop&) = delete;
  SeeingToStop& operator=(const SeeingToStop&) = delete;

 private:
  PromptKeys& keys_;
  bool before_;
};

}  // namespace

SessionConsole::SessionConsole(const ConsoleOptions& options, const Protocol& protocol, Keyboard* keyboard,
                               Clock& clock, const Interrupts& interrupts, std::unique_ptr<Display> display)
    : options_(options),
      protocol_(protocol),
      keyboard_(keyboard),
      clock_(clock),
      forces_(options.forces
                  ? std::optional<ForceTrace>(std::in_place, options.forces->devices, options.forces->in_metres)
                  : std::nullopt),
      display_(std::move(display)),
      phases_(protocol, clock),
      keys_(keyboard, interrupts, *display_, options.stop),
      question_keys_(question_keys(protocol.task)) {}

void SessionConsole::begin(const SessionCard& card) {
  SessionCard safe = card;
  for (std::string* text : {&safe.title, &safe.participant, &safe.group}) *text = printable(*text);
  display_->begin(safe);
  if (options_.large_text) display_->enlarge();
  happened(moment::kBegan);
  if (display_->by_lines() || !warned_) return;
  // What was said before the screen came has gone with it: once more, until it is read.
  warned_ = false;
  acknowledge(tr("Before the session"), announced_);
}

void SessionConsole::announce(const std::string& text, bool warning) {
  display_->announce(text, warning);
  if (display_->by_lines()) {
    announced_ += text + "\n";
    warned_ = warned_ || warning;
  } else if (warning) {
    acknowledge(tr("Please note"), text);
  }
}

void SessionConsole::acknowledge(const std::string& heading, const std::string& text) {
  const KeyMap keys = finding_keys();
  keys_.prompt();
  show({.tone = Tone::warning, .heading = heading, .text = text, .keys = keys.hints(), .to_read = true});
  while (!interrupted()) {
    const std::optional<Key> key = keys_.next();
    if (!key || display_->scroll(key->name)) continue;
    if (const auto binding = keys.binding_of(*key); !binding || !binding->asks(Request::go_on))
      explain(keys, *key);
    else if (!still_to_read(true))
      return;
  }
}

bool SessionConsole::still_to_read(bool turns_page) {
  const std::string why = display_->unread();
  if (why.empty()) return false;
  if (!turns_page || !display_->scroll(KeyName::page_down)) display_->explain(Tone::warning, why);
  return true;
}

void SessionConsole::happened(std::string_view moment) {
  if (std::exchange(exploring_, moment == moment::kExplorationBegan))
    for (SessionListener* listener : options_.listeners) listener->happened(moment::kExplorationEnded);
  if (moment == moment::kExplorationEnded) return;
  for (SessionListener* listener : options_.listeners) listener->happened(moment);
}

OperatorRequest SessionConsole::over(std::string_view moment, const std::function<OperatorRequest()>& ask) {
  happened(moment);
  OperatorRequest request = ask();
  if (request.kind == Request::go_on) happened(moment::kGoesOn);
  return request;
}

// By any of them: then no bell is needed.
bool SessionConsole::heard(CuePlace place, const CueSignal& cue) const {
  bool by_any = false;
  for (SessionListener* listener : options_.listeners) by_any = listener->cue(place, cue) || by_any;
  return by_any;
}

void SessionConsole::end(const std::string& last_words) {
  happened(moment::kEnded);
  display_->end(last_words);
}

void SessionConsole::show(const Scene& scene) {
  display_->countdown_over();  // of what this takes the place of
  scene_ = scene;
  if (!keys_.has_keyboard()) scene_.keys.clear();
  display_->scene(scene_);
}

void SessionConsole::explain(const KeyMap& keys, const Key& pressed) {
  display_->explain(stops(pressed) ? Tone::warning : Tone::quiet, keys.explanation(pressed));
}

OperatorRequest SessionConsole::request_at(const Scene& scene, const KeyMap& keys, bool pausable,
                                           const std::function<bool()>& over) {
  if (!keys_.has_keyboard()) {
    show(scene);
    return {keys_.ended() ? Request::end_for_now : Request::go_on, {}};
  }
  note_requests(keys_.prompt(), question_keys_);
  Scene with_keys = scene;
  with_keys.keys = keys.hints();
  show(with_keys);
  if (pausable) {
    if (const std::optional<OperatorRequest> request = noted_request(keys)) return *request;
  }
  for (;;) {
    tell_events();
    if (keys_.ended()) return {Request::end_for_now, {}};
    if (keys_.stopped()) return {Request::stopped, {}};
    if (pausable && keys_.pause_asked()) return {Request::pause, {}};
    if (over && over()) return {};
    const std::optional<Key> key = keys_.next();
    if (!key || display_->scroll(key->name)) continue;
    const std::optional<KeyBinding> binding = keys.binding_of(*key);
    if (!binding) {
      explain(keys, *key);
      continue;
    }
    if (scene.to_read && binding->asks(Request::go_on) && still_to_read(true)) continue;
    if (const std::optional<OperatorRequest> request = request_of(*binding, keys)) return *request;
    if (!keys_.ended()) display_->keys_again();
  }
}

OperatorRequest SessionConsole::ready(const TrialOutline& outline) {
  // An end that was asked for at the question, where a stop came in between, is still meant; a request about that trial
  // has nothing left to be about.
  if (const auto decided = std::exchange(decided_, std::nullopt);
      decided && (decided->kind == Request::end_for_now || decided->kind == Request::end_for_good))
    return *decided;
  TrialOutline shown = outline;
  // Where a limit voids a trial, an attempt of its own would say that one of the two objects is stiff.
  if (rule_repeats(protocol_)) shown.attempt = 1;
  display_->outline(shown);
  display_->log(
      tr("{} announced{}", full_name_of(shown), shown.attempt > 1 ? tr(", attempt {}", shown.attempt) : std::string()));
  display_->phase({.word = tr("READY?"), .holds = true});
  Scene scene;
  scene.heading = trial_heading(shown);
  scene.beside = beside_heading(shown);
  scene.task = tr("Wait until the participant is ready");
  scene.text = words_before(outline);
  OperatorRequest request = request_at(scene, ready_keys(outline.can_void_last), true);
  if (request.kind == Request::go_on) {
    noted_.clear();
    tell_queued();
    for (SessionListener* listener : options_.listeners) listener->trial(shown);
  }
  return request;
}

// At the beginning of a block or a round of practice, where it is another than before, and once more after a trial that
// was not as prescribed.
std::string SessionConsole::words_before(const TrialOutline& outline) {
  const std::string part =
      fmt::format("{} {} {}", outline.round, outline.practice ? 0 : outline.block, outline.prescribed);
  if (outline.prescribed.empty() || part == prescribed_) return {};
  prescribed_ = part;
  return tr("Say: {}", printable(outline.prescribed));
}

// After an interval, after free interaction that exploring() has broken off, or where judge() returned nothing.
OperatorRequest SessionConsole::meanwhile() {
  if (decided_) return *std::exchange(decided_, std::nullopt);
  if (broken_off_by_) {
    OperatorRequest request = request_of(*broken_off_by_, exploring_keys()).value_or(OperatorRequest{});
    broken_off_by_.reset();
    if (request.kind == Request::go_on) show(scene_);
    return request;
  }
  hear_in_trial();
  const auto repeat = std::find_if(noted_.begin(), noted_.end(), asks_to_repeat);
  if (repeat == noted_.end()) return {};
  const KeyBinding key = *repeat;
  noted_.erase(repeat);
  tell_queued();
  return request_of(key, question_keys_).value_or(OperatorRequest{});
}

OperatorRequest SessionConsole::paused(const std::string& cause) {
  Scene scene;
  scene.tone = Tone::warning;
  scene.heading = tr("Paused");
  if (cause == "ctrl-c") scene.beside = tr("by Ctrl-C; once more ends the session safely");
  if (phases_.pause_begins()) display_->log(cause == "ctrl-c" ? tr("paused by Ctrl-C") : tr("paused"));
  display_->phase(phases_.pause());
  OperatorRequest request = over(moment::kPaused, [&] { return request_at(scene, pause_keys(), false); });
  if (request.kind == Request::note) return request;  // it goes on
  display_->log(tr("the pause is over after {}", duration_text(phases_.pause_over())));
  return request;
}

void SessionConsole::progress(const std::vector<ConditionProgress>& by_condition) {
  display_->progress(by_condition);
}

void SessionConsole::health(const DeviceHealth& health) {
  keys_.look_at_stop();
  DeviceHealth shown = health;
  if (!shown.fault.empty()) shown.fault = reason_text(shown.fault);
  if (health.presenting && presenting_) display_->phase(phases_.interval(health));
  show_forces(!health.presenting);
  display_->health(shown);
  if (!shown.fault.empty() && options_.alerts) display_->alert();
  if (!health.presenting && std::exchange(presenting_, false))
    for (SessionListener* listener : options_.listeners) listener->interval_over();
  // Where a key ends an interval enough() hears the keys.
  if (health.presenting && task_of(protocol_.task.kind).has_trials() &&
      protocol_.timeline.interval_end != IntervalEnd::key)
    hear_in_trial();
}

void SessionConsole::show_forces(bool over) {
  if (!forces_) return;
  forces_->take(*options_.forces->ticks);
  display_->forces(*forces_);
  if (!over) return;
  forces_->presentation_over();
  if (!presenting_) return;
  for (const ForceTrace::Device& device : forces_->devices()) {
    const std::string text = fmt::format("{}: {}", printable(device.name), peak_text(device, forces_->in_metres()));
    if (display_->by_lines())
      display_->tell(Tone::quiet, text);
    else
      display_->log(text);
  }
}

void SessionConsole::cue(CuePlace place, const CueSignal& cue) {
  const bool by_any = heard(place, cue);
  const bool aloud = !cue.say.empty(), beep = !by_any && cue.kind == "sound";
  presenting_ = place != CuePlace::question;
  const std::string words = aloud ? printable(cue.say) : usual_words(place, protocol_);
  if (place == CuePlace::question) {
    display_->phase({.word = tr("QUESTION"), .shade = Shade::question});
    display_->log(tr("the question is asked"));
    display_->say(place, words, aloud, beep);
    if (options_.alerts && !beep && !by_any) display_->alert();
    // Only now can it be answered: a key or a button that came while it was drawn is early.
    note_requests(keys_.prompt(), question_keys_);
    if (options_.buttons != nullptr) options_.buttons->ask();
    if (options_.rig_buttons != nullptr && !protocol_.task.answers.empty()) {
      std::vector<std::string> words_of_answers;
      for (const AnswerChoice& answer : protocol_.task.answers) words_of_answers.push_back(answer.word);
      options_.rig_buttons->ask(words_of_answers);
    }
    cue_shown_ns_ = clock_.now_ns();
    return;
  }
  asks_enough_ = false;
  display_->phase(phases_.interval_begins(place));
  display_->log(tr("interval: {}", words));
  if (keys_.has_keyboard()) display_->working_keys(presentation_keys(protocol_).hints());
  display_->say(place, words, aloud, beep);
}

bool SessionConsole::gap(double left_s, double total_s) {
  keys_.look_at_stop();
  display_->phase({.word = tr("GAP"), .left_s = left_s, .total_s = total_s});
  if (!keys_.has_keyboard()) return true;
  // In a quick rehearsal the session's clock runs ahead of keys and eyes.
  if (seconds_since(looked_ns_) < kLook_s / 2) return true;
  looked_ns_ = SteadyClock().now_ns();
  hear_in_trial();
  display_->refresh();
  return std::none_of(noted_.begin(), noted_.end(), asks_to_repeat);
}

OperatorRequest SessionConsole::hand_over(const HandOver& what) {
  Scene scene;
  scene.tone = Tone::strong;
  scene.heading = tr("Hand over  {}", items_text(what));
  scene.beside = printable(what.condition);
  display_->phase({.word = tr("HAND OVER"), .holds = true});
  return request_at(scene, hand_over_keys(protocol_.task), true);
}

void SessionConsole::saved(const TrialOutline& outline, const Answer& answer) {
  last_answered_ = full_name_of(outline);
  counts_.no_contact = 0;
  display_->counts(counts_);
  for (SessionListener* listener : options_.listeners) listener->answered(outline, answer);
  // A value that was settled on was presented: it is a stimulus.
  const bool gives_away = protocol_.blinded && task_of(protocol_.task.kind).adjusts();
  const std::string said = gives_away ? std::string() : answer_text(answer, protocol_.task) + ", ";
  display_->answer(name_of(outline), fmt::format("{}{:.2f} s", said, answer.response_time_s),
                   std::string(translated(to_string(answer.entered_by))));
}

void SessionConsole::off_prescription(const TrialOutline& outline) {
  prescribed_.clear();
  display_->tell(Tone::warning, tr("{} was not felt as prescribed; it is marked", full_name_of(outline)));
}

void SessionConsole::not_as_asked(const Deliveries& deliveries) {
  display_->tell(Tone::warning, not_as_asked_text(deliveries));
}

void SessionConsole::voided(const TrialOutline& outline, const std::string& reason, bool will_repeat) {
  if (reason == "off_prescription") prescribed_.clear();
  ++counts_.voids;
  counts_.no_contact = reason == "no_contact" ? counts_.no_contact + 1 : 0;
  display_->counts(counts_);
  for (SessionListener* listener : options_.listeners) listener->voided(outline, reason);
  if (keys_.has_keyboard()) display_->working_keys(between_trials_keys(protocol_.task).hints());
  display_->tell(Tone::warning,
                 tr("{} not counted ({}); {}", full_name_of(outline), reason_text(reason),
                    will_repeat ? tr("it comes again at the end of this block") : tr("its attempts are used up")));
}

void SessionConsole::took_back(bool will_repeat) {
  happened(moment::kTakenBack);
  display_->answer_taken_back();
  display_->tell(Tone::warning, tr("{} taken back; {}",
                                   last_answered_.empty() ? tr("last answer") : tr("answer to {}", last_answered_),
                                   will_repeat ? tr("its trial comes again at the end of its block")
                                               : tr("the attempts of its trial are used up")));
  last_answered_.clear();
}

bool SessionConsole::waiting(double left_s, double total_s) {
  keys_.look_at_stop();
  if (!keys_.has_keyboard()) return true;
  tell_events();
  // In a quick rehearsal the session's clock runs ahead of keys and eyes.
  if (seconds_since(looked_ns_) < kLook_s / 2) return true;
  looked_ns_ = SteadyClock().now_ns();
  const KeyMap between = between_trials_keys(protocol_.task);
  for (const Key& key : keys_.heard()) {
    if (!between.binding_of(key)) explain(between, key);
    note_requests({key}, between);
  }
  display_->phase({.word = tr("NEXT TRIAL"), .left_s = left_s, .total_s = total_s});
  // A page that came between, such as a note's or a pause's, is over.
  if (!scene_.heading.empty()) {
    scene_ = {};
    display_->working_keys(between.hints());
  }
  if (total_s >= kCounted_s) display_->countdown(tr("next trial"), left_s, total_s);
  display_->refresh();
  std::erase_if(noted_, asks_to_repeat);  // its trial is over
  tell_queued();
  return noted_.empty();
}

OperatorRequest SessionConsole::recover(const std::string& stopped_by) {
  keys_.show_stop(printable(stopped_by));
  if (options_.alerts) display_->alert();
  Scene scene{Tone::warning,
              tr("STOPPED ({}). The devices are at rest.", translated(printable(stopped_by))),
              "",
              tr("See to the participant and the devices. A trial that was under way comes again later."),
              {}};
  if (!keys_.has_keyboard()) {
    show(scene);
    return {Request::end_for_now, {}};
  }
  keys_.see_to_stop(true);
  OperatorRequest request = over(moment::kStopped, [&] { return request_at(scene, stopped_keys(), true); });
  // A pause in it is still in it.
  if (request.kind == Request::go_on) {
    keys_.see_to_stop(false);
    keys_.stop_cleared();
  }
  return request;
}

OperatorRequest SessionConsole::missing(const std::string& what, const std::function<bool()>& back) {
  const Scene scene{
      Tone::warning,
      tr("Something is missing."),
      "",
      printable(what) + "\n" + tr("The devices are at rest. It goes on by itself as soon as all is there again."),
      {}};
  display_->phase({.word = tr("MISSING"), .holds = true, .shade = Shade::warning});
  if (options_.alerts) display_->alert();
  OperatorRequest request = over(moment::kMissing, [&] { return request_at(scene, missing_keys(), true, back); });
  if (request.kind == Request::go_on && keys_.has_keyboard()) display_->tell(Tone::quiet, tr("all is there again"));
  return request;
}

bool SessionConsole::storage_trouble(const std::string& message) {
  if (!keys_.has_keyboard()) return false;
  // A stop has to wait here: what comes of it could not be written, and the devices give nothing anyway.
  const SeeingToStop first(keys_);
  const KeyMap keys = storage_keys();
  display_->phase({.word = tr("NOT SAVED"), .holds = true, .shade = Shade::warning});
  if (options_.alerts) display_->alert();
  keys_.prompt();
  show({Tone::warning, tr("The study cannot be written just now."), "",
        printable(message) + "\n" + tr("The devices are at rest. Nothing is lost yet: see to it, then try again."),
        keys.hints()});
  while (!keys_.ended()) {
    const std::optional<Key> key = keys_.next();
    if (!key) continue;
    const std::optional<KeyBinding> binding = keys.binding_of(*key);
    if (binding && binding->asks(Request::go_on)) return true;
    if (binding && binding->asks(Request::end_for_now)) {
      if (confirm(tr("End the session? What was not saved is lost."))) return false;
      display_->keys_again();
    } else {
      explain(keys, *key);
    }
  }
  return false;
}

void SessionConsole::feedback(bool correct) {
  display_->feedback(correct ? tr("that was right") : tr("that was not right"));
}

void SessionConsole::practice_over(int rounds, double share_correct, bool passed) {
  const std::string criterion = passed ? std::string() : tr(", below the protocol's criterion; this is in the log");
  // Where nobody was told which answers were right, their number tells classes.
  const bool gives_away = protocol_.blinded && protocol_.practice->feedback == Feedback::none;
  const std::string right = gives_away ? std::string() : tr(": {:.0f} % right", 100 * share_correct);
  display_->announce(rounds == 1 ? tr("Practice is over after 1 round{}{}.", right, criterion)
                                 : tr("Practice is over after {} rounds{}{}.", rounds, right, criterion),
                     false);
}

void SessionConsole::break_begins(const Break& pause, bool asked_by_operator) {
  phases_.break_begins(pause.duration_s);
  Scene scene;
  scene.heading = tr("Break");
  scene.beside = asked_by_operator ? tr("at your wish") : tr("of at least {}", duration_text(pause.duration_s));
  if (!pause.say.empty()) scene.text = tr("Say: {}", printable(pause.say));
  if (keys_.has_keyboard() && pause.duration_s > 0) scene.keys = break_keys(false).hints();
  note_requests(keys_.prompt(), question_keys_);
  display_->log(asked_by_operator ? tr("a break begins, at your wish") : tr("a break begins"));
  display_->phase(phases_.break_now());
  show(scene);
  break_scene_ = scene;
  happened(moment::kBreakBegan);
}

// Asked again after a note or a pause: the countdown goes on.
OperatorRequest SessionConsole::break_over(const Break& pause) {
  const KeyMap keys = break_keys(false);
  if (!display_->by_lines() && phases_.break_left_s() > 0) show(break_scene_);  // a pause had the screen
  while (phases_.break_left_s() > 0) {
    const double left_s = phases_.break_left_s();
    if (keys_.ended()) return {Request::end_for_now, {}};
    if (keys_.stopped()) return {Request::stopped, {}};
    if (keys_.pause_asked()) return {Request::pause, {}};
    tell_events();
    display_->phase(phases_.break_now());
    display_->countdown(tr("break"), left_s, pause.duration_s);
    display_->refresh();
    for (const Key& key : keys_.heard()) {
      const std::optional<KeyBinding> binding = keys.binding_of(key);
      if (!binding) {
        if (key.is(U' ') || key.is(KeyName::enter))
          display_->explain(Tone::quiet, tr("the break is not over: {} left", duration_text(left_s)));
        else
          explain(keys, key);
        continue;
      }
      if (const std::optional<OperatorRequest> request = request_of(*binding, keys)) return *request;
    }
    clock_.sleep_until_ns(
        std::min(phases_.break_ends_ns(), clock_.now_ns() + static_cast<std::int64_t>(kLook_s * 1e9)));
  }
  display_->countdown_over();
  display_->phase(phases_.break_now());
  if (pause.duration_s > 0 && options_.alerts) display_->alert();
  OperatorRequest request{keys_.ended() ? Request::end_for_now : Request::go_on, {}};
  if (keys_.has_keyboard())
    request = request_at({Tone::strong, tr("The break may end"), "", "", {}}, break_keys(true), true);
  if (request.kind == Request::go_on) {
    display_->log(tr("the break is over after {}", duration_text(phases_.break_lasted_s())));
    happened(moment::kGoesOn);
  }
  return request;
}

OperatorRequest SessionConsole::instruct(const Instruction& instruction) {
  display_->phase({.word = tr("READ OUT"), .holds = true});
  return request_at({.heading = tr("Instructions"),
                     .beside = tr("read them out, or let the participant read them"),
                     .text = instruction.text,
                     .to_read = true},
                    instruction_keys(), true);
}

std::optional<bool> SessionConsole::consent(const std::string& text) {
  if (!keys_.has_keyboard()) return !keys_.ended();
  const KeyMap keys = consent_keys();
  display_->phase({.word = tr("CONSENT"), .holds = true, .shade = Shade::question});
  keys_.prompt();
  show({.heading = tr("Consent"),
        .beside = tr("read it out, or let the participant read it"),
        .text = text,
        .keys = keys.hints(),
        .to_read = true});
  while (!interrupted()) {
    const std::optional<Key> key = keys_.next();
    if (!key || display_->scroll(key->name)) continue;
    const std::optional<KeyBinding> binding = keys.binding_of(*key);
    if (binding && !binding->asks(Request::stopped)) {
      // Nobody has to read to the end to refuse.
      const bool agrees = binding->asks(Request::go_on);
      if (agrees && still_to_read()) continue;
      if (agrees) return true;
      if (confirm(tr("No consent: the session ends for good. Is that right?"))) return false;
      if (!keys_.ended()) display_->keys_again();
    } else {
      explain(keys, *key);
    }
  }
  if (keys_.ended()) request_interrupt();  // no answer is no refusal
  return std::nullopt;
}

OperatorRequest SessionConsole::ready_to_explore(const ExplorationOutline& outline) {
  Scene scene;
  scene.heading = tr("Free interaction {} of {}", outline.number, outline.total);
  scene.beside = tr("condition {}  {}", printable(outline.condition_code), duration_text(outline.duration_s));
  if (outline.attempt > 1) scene.beside += tr("  (attempt {})", outline.attempt);
  scene.text = tr("Object: {}. {}", printable(outline.object),
                  outline.devices ? tr("The participant wears the devices.") : tr("Bare hands: take the devices off."));
  exploring_s_ = outline.duration_s;
  display_->phase({.word = tr("READY?"), .holds = true});
  happened(moment::kExplorationEnded);  // of one that did not count
  OperatorRequest request = request_at(scene, ready_keys(false), true);
  if (request.kind == Request::go_on) happened(moment::kExplorationBegan);
  if (request.kind == Request::go_on && keys_.has_keyboard()) {
    scene.keys = exploring_keys().hints();
    scene.text.clear();
    display_->phase({.word = tr("EXPLORE")});
    display_->log(tr("free interaction {} begins", outline.number));
    show(scene);
  }
  return request;
}

void SessionConsole::explored() {
  happened(moment::kExplorationEnded);
}

// What the operator presses lets the object go; meanwhile() then asks what it is about, and it goes on.
bool SessionConsole::exploring(double left_s) {
  keys_.look_at_stop();
  tell_events();
  display_->countdown(tr("time left"), left_s, exploring_s_);
  display_->refresh();
  if (broken_off_by_) return false;
  const KeyMap keys = exploring_keys();
  for (const Key& key : keys_.heard()) {
    const std::optional<KeyBinding> binding = keys.binding_of(key);
    if (!binding) explain(keys, key);
    if (binding && !binding->asks(Request::stopped) && !broken_off_by_) broken_off_by_ = binding;
  }
  return !broken_off_by_;
}

}  // namespace jnd
