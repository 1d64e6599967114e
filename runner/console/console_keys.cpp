#include "runner/console/console_keys.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "protocols/input/utf8.h"
#include "protocols/tasks/task.h"
#include "runner/keys/keyboard.h"
#include "runner/keys/line_editor.h"

namespace jnd {

namespace {

const KeyBinding kStop{kStopKey, Request::stopped, "STOP the devices", true};

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
  const std::string word(said_word(task, said));
  return sureness == 0 ? word : fmt::format("{}, {} of {} sure", word, sureness, task.sureness_levels);
}

}  // namespace

std::string key_name(char32_t character) {
  return character == ' ' ? "space" : to_utf8(std::u32string(1, character));
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
      return "that key";
  }
}

std::optional<KeyBinding> KeyMap::binding_of(const Key& key) const {
  const char32_t wanted = key.is(KeyName::enter) ? U' ' : key.name == KeyName::character ? key.character : 0;
  if (wanted == 0) return std::nullopt;
  for (const KeyBinding& binding : bindings_)
    if (binding.key == wanted) return binding;
  // As a capital it has stopped the devices too.
  for (const KeyBinding& binding : bindings_)
    if (binding.asks(Request::stopped) && capital(binding.key) == wanted) return binding;
  return std::nullopt;
}

std::vector<KeyHint> KeyMap::hints() const {
  std::vector<KeyHint> hints;
  for (const KeyBinding& binding : bindings_)
    hints.push_back({key_name(binding.key), binding.what, binding.brief, binding.asks(Request::stopped)});
  return hints;
}

KeyHint stop_hint() {
  return {key_name(kStop.key), kStop.what, true, true};
}

KeyHint stop_hint_of_text() {
  return {"Ctrl-C", "STOP, pause", true, true};
}

KeyMap KeyMap::without(std::initializer_list<KeyMeaning> meanings) const {
  std::vector<KeyBinding> rest = bindings_;
  std::erase_if(rest, [&](const KeyBinding& binding) {
    return std::find(meanings.begin(), meanings.end(), binding.meaning) != meanings.end();
  });
  return KeyMap(std::move(rest));
}

bool stops(const Key& key) noexcept {
  return key.is(static_cast<char32_t>(kStopKey)) || key.is(capital(kStopKey));
}

std::string KeyMap::explanation(const Key& pressed) const {
  if (stops(pressed)) return "STOP: the devices give nothing";
  if (pressed.is(KeyName::control) && pressed.character == 'z')
    return "a session is not put into the background: the devices may be on a finger. p pauses, q ends";
  const std::string name = key_name(pressed);
  // The commonest mistake: Caps Lock, or the other case.
  for (const KeyBinding& binding : bindings_)
    if (pressed.name == KeyName::character && binding.key != pressed.character &&
        capital(binding.key) == capital(pressed.character))
      return fmt::format("[{}] does nothing, [{}] {}: is Caps Lock on?", name, key_name(binding.key), binding.what);
  std::string text = fmt::format("[{}] does nothing here:", name);
  for (const KeyBinding& binding : bindings_)
    if (binding.brief) text += fmt::format(" [{}] {},", key_name(binding.key), binding.what);
  text.pop_back();
  return text;
}

KeyMap ready_keys(bool can_void_last) {
  const KeyMap keys({{' ', Request::go_on, "when the participant is ready", true},
                     kStop,
                     {'p', Request::pause, "pause", false},
                     {'u', Request::void_last, "take back the last answer", false},
                     {'n', Request::note, "note", false},
                     {'b', Request::take_break, "break", false},
                     {'k', Request::end_block, "end this block", false},
                     {'q', Request::end_for_now, "end", true},
                     {'?', HelpWanted{}, "all keys", true}});
  return can_void_last ? keys : keys.without({Request::void_last});
}

KeyMap question_keys(const TaskSpec& task) {
  const auto key = [&](char32_t letter) { return spared(letter, task); };
  std::vector<KeyBinding> bindings;
  for (const AnswerChoice& answer : task.answers)
    bindings.push_back({static_cast<char32_t>(answer.key), GivenAnswer{answer.said, answer.sureness},
                        words_of(answer.said, answer.sureness, task), true});
  bindings.insert(bindings.end(), {kStop,
                                   {key('r'), Request::repeat_trial, "repeat this trial", true},
                                   {key('p'), Request::pause, "pause after this trial", false},
                                   {key('n'), Request::note, "note after this trial", false},
                                   {key('q'), Request::end_for_now, "end", true},
                                   {'?', HelpWanted{}, "all keys", false}});
  return KeyMap(std::move(bindings));
}

KeyMap hand_over_keys(const TaskSpec& task) {
  const auto key = [&](char32_t letter) { return spared(letter, task); };
  return KeyMap({{' ', Request::go_on, "when the participant has it", true},
                 kStop,
                 {key('r'), Request::repeat_trial, "repeat this trial", true},
                 {key('n'), Request::note, "note", false},
                 {key('q'), Request::end_for_now, "end", true},
                 {'?', HelpWanted{}, "all keys", false}});
}

KeyMap presentation_keys(const Protocol& protocol) {
  const auto key = [&](char32_t letter) { return spared(letter, protocol.task); };
  const KeyMap keys({{' ', Request::go_on, "felt enough", true},
                     kStop,
                     {key('r'), Request::repeat_trial, "repeat it, after this interval", true},
                     {key('p'), Request::pause, "pause after this trial", false},
                     {key('n'), Request::note, "note after this trial", false},
                     {key('q'), Request::end_for_now, "end after this trial", true}});
  return protocol.timeline.interval_end == IntervalEnd::key ? keys : keys.without({Request::go_on});
}

KeyMap between_trials_keys(const TaskSpec& task) {
  const auto key = [&](char32_t letter) { return spared(letter, task); };
  return KeyMap({kStop,
                 {key('p'), Request::pause, "pause", true},
                 {key('n'), Request::note, "note", true},
                 {key('q'), Request::end_for_now, "end", true}});
}

KeyMap pause_keys() {
  return KeyMap({{' ', Request::go_on, "goes on", true},
                 kStop,
                 {'n', Request::note, "note", true},
                 {'q', Request::end_for_now, "ends the session", true}});
}

KeyMap stopped_keys() {
  return KeyMap({{'c', Request::go_on, "clears the stop and goes on", true,
                  "Clears the stop. What was the matter? Or Enter (Esc: no)"},
                 {'n', Request::note, "note", true},
                 {'q', Request::end_for_now, "ends the session", true}});
}

KeyMap missing_keys() {
  return pause_keys().without({Request::go_on});
}

KeyMap break_keys(bool over) {
  const KeyMap keys = pause_keys();
  return over ? keys : keys.without({Request::go_on});
}

KeyMap instruction_keys() {
  return KeyMap({{' ', Request::go_on, "goes on", true},
                 kStop,
                 {'p', Request::pause, "pause", false},
                 {'n', Request::note, "note", true},
                 {'q', Request::end_for_now, "ends the session", true}});
}

KeyMap finding_keys() {
  return KeyMap({{' ', Request::go_on, "goes on", true}, kStop});
}

KeyMap consent_keys() {
  return KeyMap({{'y', Request::go_on, "the participant agrees", true},
                 {'n', Request::end_for_good, "the participant does not agree", true},
                 kStop});
}

KeyMap ready_to_explore_keys() {
  return KeyMap({{' ', Request::go_on, "when the participant is ready", true},
                 kStop,
                 {'p', Request::pause, "pause", false},
                 {'n', Request::note, "note", false},
                 {'b', Request::take_break, "break", false},
                 {'k', Request::end_block, "end this block", false},
                 {'q', Request::end_for_now, "end", true},
                 {'?', HelpWanted{}, "all keys", true}});
}

KeyMap exploring_keys() {
  return KeyMap({kStop,
                 {'r', Request::repeat_trial, "break off, again later", true},
                 {'k', Request::end_block, "enough of it", true, "Ends it early. Reason, or Enter (Esc: no)"},
                 {'p', Request::pause, "pause", true},
                 {'n', Request::note, "note", true},
                 {'q', Request::end_for_now, "end", true}});
}

KeyMap storage_keys() {
  return KeyMap({{' ', Request::go_on, "tries again", true},
                 kStop,
                 {'q', Request::end_for_now, "ends the session; what was not saved is lost", true}});
}

}  // namespace jnd
