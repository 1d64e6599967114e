#include "runner/console/console_keys.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "protocols/input/utf8.h"
#include "protocols/tasks/task.h"
#include "runner/console/session_words.h"
#include "runner/keys/keyboard.h"
#include "runner/keys/line_editor.h"
#include "runner/words/words.h"

namespace jnd {

namespace {

KeyBinding stop_binding() {
  return {kStopKey, Request::stopped, tr("STOP the devices"), true};
}

char32_t capital(char32_t letter) {
  return letter >= 'a' && letter <= 'z' ? letter - 'a' + 'A' : letter;
}

// The operator's letter, or where it is an answer key the one that takes its place.
char32_t spared(char32_t letter, const TaskSpec& task) {
  const auto answers = [&](char32_t candidate) {
    return std::any_of(task.answers.begin(), task.answers.end(), [candidate](const AnswerChoice& answer) {
      return static_cast<char32_t>(answer.key) == candidate;
    });
  };
  for (const char32_t candidate : {letter, capital(letter), U'0', U'8', U'9'})
    if (!answers(candidate)) return candidate;
  return letter;
}

// "different", or with its sureness "different, 2 of 3".
std::string words_of(int said, int sureness, const TaskSpec& task) {
  const std::string said_so = shown_answer(task, said);
  return sureness == 0 ? said_so : tr("{}, {} of {} sure", said_so, sureness, task.sureness_levels);
}

}  // namespace

std::string key_name(char32_t character) {
  return character == ' ' ? tr("space") : to_utf8(std::u32string(1, character));
}

std::string answer_text(const Answer& answer, const TaskSpec& task) {
  return answer.number ? fmt::format("{:g}", *answer.number) : words_of(answer.said, answer.sureness, task);
}

std::string key_name(const Key& key) {
  switch (key.name) {
    case KeyName::character:
      return key_name(key.character);
    case KeyName::enter:
      return "Enter";
    case KeyName::escape:
      return "Esc";
    case KeyName::control:
      return "Ctrl-" + to_utf8(std::u32string(1, capital(key.character)));
    default:
      return tr("that key");
  }
}

std::optional<KeyBinding> KeyMap::binding_of(const Key& key) const {
  const char32_t wanted = key.is(KeyName::enter) ? U' ' : key.name == KeyName::character ? key.character : 0;
  if (wanted == 0) return std::nullopt;
  for (const KeyBinding& binding : bindings_)
    if (binding.key == wanted && binding.why_not.empty()) return binding;
  // As a capital it has stopped the devices too.
  for (const KeyBinding& binding : bindings_)
    if (binding.asks(Request::stopped) && capital(binding.key) == wanted) return binding;
  return std::nullopt;
}

std::vector<KeyHint> KeyMap::hints() const {
  std::vector<KeyHint> hints;
  for (const KeyBinding& binding : bindings_)
    hints.push_back({key_name(binding.key), binding.what, binding.brief, binding.asks(Request::stopped),
                     binding.why_not.empty(), binding.place, binding.label});
  return hints;
}

KeyHint stop_hint() {
  return {key_name(static_cast<char32_t>(kStopKey)), stop_binding().what, true, true};
}

KeyHint stop_hint_of_text() {
  return {"Ctrl-C", tr("STOP, pause"), true, true};
}

bool stops(const Key& key) noexcept {
  return key.is(static_cast<char32_t>(kStopKey)) || key.is(capital(kStopKey));
}

std::string KeyMap::explanation(const Key& pressed) const {
  if (stops(pressed)) return tr("STOP: the devices give nothing");
  if (pressed.is(KeyName::control) && pressed.character == 'z')
    return tr("a session is not put into the background, because the devices may be on a finger: pause it, or end it");
  const std::string name = key_name(pressed);
  for (const KeyBinding& binding : bindings_)
    if (pressed.is(binding.key) && !binding.why_not.empty())
      return tr("[{}] {} does nothing now: {}", name, binding.label, binding.why_not);
  // The commonest mistake: Caps Lock, or the other case.
  for (const KeyBinding& binding : bindings_)
    if (pressed.name == KeyName::character && binding.key != pressed.character && binding.why_not.empty() &&
        capital(binding.key) == capital(pressed.character))
      return tr("[{}] does nothing, [{}] {}: is Caps Lock on?", name, key_name(binding.key), binding.what);
  std::string text = tr("[{}] does nothing here:", name);
  for (const KeyBinding& binding : bindings_)
    if (binding.brief) text += fmt::format(" [{}] {},", key_name(binding.key), binding.what);
  text.pop_back();
  return text;
}

// The operator's own keys, which stand at the same place in every scene of a session.
namespace {

struct OwnKey {
  char32_t key;
  Request request;
  const char* label;
};
constexpr std::array<OwnKey, 7> kOwnKeys = {{{'p', Request::pause, word("pause")},
                                             {'r', Request::repeat_trial, word("repeat")},
                                             {'u', Request::void_last, word("undo")},
                                             {'n', Request::note, word("note")},
                                             {'b', Request::take_break, word("break")},
                                             {'k', Request::end_block, word("end block")},
                                             {'q', Request::end_for_now, word("end")}}};

// What an own key does in a scene.
struct Own {
  Request request;
  std::string what;
  bool brief = false;
  std::string reason{};
};
using WhyNot = std::string (*)(Request);

// main: the scene's keys, first. own: those of the operator's that work; why_not says of the others why they do not.
KeyMap scene_keys(std::vector<KeyBinding> main, const std::vector<Own>& own, WhyNot why_not,
                  const TaskSpec* task = nullptr, bool help_brief = false) {
  for (const OwnKey& place : kOwnKeys) {
    KeyBinding binding{.key = task == nullptr ? place.key : spared(place.key, *task),
                       .meaning = place.request,
                       .label = std::string(translated(place.label)),
                       .place = true};
    const auto works =
        std::find_if(own.begin(), own.end(), [&](const Own& one) { return one.request == place.request; });
    binding.brief = works != own.end() && works->brief;
    binding.what = works != own.end() ? works->what : binding.label;
    if (works != own.end()) binding.reason = works->reason;
    if (works == own.end()) binding.why_not = why_not(place.request);
    main.push_back(std::move(binding));
  }
  main.push_back({.key = '?',
                  .meaning = HelpWanted{},
                  .what = tr("all keys"),
                  .brief = help_brief,
                  .label = tr("keys"),
                  .place = true});
  return KeyMap(std::move(main));
}

std::string not_before_trial(Request request) {
  return request == Request::void_last ? tr("no answer of this part of the session can be taken back")
                                       : tr("no trial is under way; undo takes the last answer back");
}
std::string not_in_trial(Request request) {
  switch (request) {
    case Request::void_last:
      return tr("an answer is taken back between trials; repeat brings this trial again");
    case Request::take_break:
      return tr("a break begins between trials");
    case Request::end_block:
      return tr("a block is ended between trials");
    default:
      return tr("a trial is under way: first the answer");
  }
}
std::string not_between_trials(Request request) {
  if (request == Request::repeat_trial)
    return tr("its trial is over; undo takes the answer back, once the next is announced");
  return tr("wait until the next trial is announced");
}
std::string not_in_pause(Request request) {
  return request == Request::pause ? tr("it is paused already") : tr("end the pause first: [space]");
}
std::string not_in_break(Request request) {
  return request == Request::pause || request == Request::take_break ? tr("it is a break already")
                                                                     : tr("the break comes first");
}
std::string not_stopped(Request) {
  return tr("clear the stop first: [c]");
}
std::string not_missing(Request) {
  return tr("it waits for what is missing");
}
std::string not_in_text(Request) {
  return tr("no trial is under way");
}
std::string not_exploring(Request request) {
  return request == Request::void_last ? tr("there is no answer to take back")
                                       : tr("an object is being explored: [k] ends it");
}

}  // namespace

KeyMap ready_keys(bool can_void_last) {
  std::vector<Own> own = {{Request::pause, tr("pause")},
                          {Request::note, tr("note")},
                          {Request::take_break, tr("break")},
                          {Request::end_block, tr("end this block")},
                          {Request::end_for_now, tr("end"), true}};
  if (can_void_last) own.push_back({Request::void_last, tr("take back the last answer")});
  return scene_keys({{' ', Request::go_on, tr("when the participant is ready"), true}, stop_binding()}, own,
                    not_before_trial, nullptr, true);
}

KeyMap question_keys(const TaskSpec& task) {
  std::vector<KeyBinding> main;
  for (const AnswerChoice& answer : task.answers)
    main.push_back({static_cast<char32_t>(answer.key), GivenAnswer{answer.said, answer.sureness},
                    words_of(answer.said, answer.sureness, task), true});
  main.push_back(stop_binding());
  return scene_keys(std::move(main),
                    {{Request::repeat_trial, tr("repeat this trial"), true},
                     {Request::pause, tr("pause after this trial")},
                     {Request::note, tr("note after this trial")},
                     {Request::end_for_now, tr("end"), true}},
                    not_in_trial, &task);
}

KeyMap hand_over_keys(const TaskSpec& task) {
  return scene_keys({{' ', Request::go_on, tr("when the participant has it"), true}, stop_binding()},
                    {{Request::repeat_trial, tr("repeat this trial"), true},
                     {Request::note, tr("note")},
                     {Request::end_for_now, tr("end"), true}},
                    not_in_trial, &task);
}

KeyMap presentation_keys(const Protocol& protocol) {
  std::vector<KeyBinding> main;
  if (protocol.timeline.interval_end == IntervalEnd::key)
    main.push_back({' ', Request::go_on, tr("felt enough"), true});
  main.push_back(stop_binding());
  return scene_keys(std::move(main),
                    {{Request::repeat_trial, tr("repeat it, after this interval"), true},
                     {Request::pause, tr("pause after this trial")},
                     {Request::note, tr("note after this trial")},
                     {Request::end_for_now, tr("end after this trial"), true}},
                    not_in_trial, &protocol.task);
}

KeyMap between_trials_keys(const TaskSpec& task) {
  return scene_keys(
      {stop_binding()},
      {{Request::pause, tr("pause"), true}, {Request::note, tr("note"), true}, {Request::end_for_now, tr("end"), true}},
      not_between_trials, &task);
}

KeyMap pause_keys() {
  return scene_keys({{' ', Request::go_on, tr("goes on"), true}, stop_binding()},
                    {{Request::note, tr("note"), true}, {Request::end_for_now, tr("ends the session"), true}},
                    not_in_pause);
}

KeyMap stopped_keys() {
  return scene_keys({{'c', Request::go_on, tr("clears the stop and goes on"), true,
                      tr("Clears the stop. What was the matter? Or Enter (Esc: no)")}},
                    {{Request::note, tr("note"), true}, {Request::end_for_now, tr("ends the session"), true}},
                    not_stopped);
}

KeyMap missing_keys() {
  return scene_keys({stop_binding()},
                    {{Request::note, tr("note"), true}, {Request::end_for_now, tr("ends the session"), true}},
                    not_missing);
}

KeyMap break_keys(bool over) {
  std::vector<KeyBinding> main;
  if (over) main.push_back({' ', Request::go_on, tr("goes on"), true});
  main.push_back(stop_binding());
  return scene_keys(std::move(main),
                    {{Request::note, tr("note"), true}, {Request::end_for_now, tr("ends the session"), true}},
                    not_in_break);
}

KeyMap instruction_keys() {
  return scene_keys({{' ', Request::go_on, tr("goes on"), true}, stop_binding()},
                    {{Request::pause, tr("pause")},
                     {Request::note, tr("note"), true},
                     {Request::end_for_now, tr("ends the session"), true}},
                    not_in_text);
}

KeyMap finding_keys() {
  return KeyMap({{' ', Request::go_on, tr("goes on"), true}, stop_binding()});
}

KeyMap consent_keys() {
  return KeyMap({{'y', Request::go_on, tr("the participant agrees"), true},
                 {'n', Request::end_for_good, tr("the participant does not agree"), true},
                 stop_binding()});
}

KeyMap exploring_keys() {
  return scene_keys({stop_binding()},
                    {{Request::repeat_trial, tr("break off, again later"), true},
                     {Request::end_block, tr("enough of it"), true, tr("Ends it early. Reason, or Enter (Esc: no)")},
                     {Request::pause, tr("pause"), true},
                     {Request::note, tr("note"), true},
                     {Request::end_for_now, tr("end"), true}},
                    not_exploring);
}

KeyMap storage_keys() {
  return KeyMap({{' ', Request::go_on, tr("tries again"), true},
                 stop_binding(),
                 {'q', Request::end_for_now, tr("ends the session; what was not saved is lost"), true}});
}

}  // namespace jnd
