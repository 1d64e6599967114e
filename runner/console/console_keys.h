// What the operator's keys do, by what the session waits for.
#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "protocols/protocol.h"
#include "runner/keys/key_parser.h"

namespace jnd {

enum class Action {
  go_on,
  pause,
  repeat_trial,
  void_last,
  note,
  end_block,
  enough,  // of free interaction
  take_break,
  end_session,
  clear_stop,
  answer_same,
  answer_different,
  consent,
  refuse,
  try_again,
  give_up,
  stop,  // the keyboard's own thread has done it already
  help
};

struct KeyHint {
  std::string key;    // as printed: "space", "p", "Enter"
  std::string what;   // what it does
  bool brief = true;  // also where there is room for the most important keys only
  bool stop = false;  // shown at every size
};

struct KeyBinding {
  char32_t key = 0;  // ' ' is also Enter
  Action action = Action::go_on;
  std::string what;
  bool brief = true;
};

class KeyMap {
 public:
  explicit KeyMap(std::vector<KeyBinding> bindings) : bindings_(std::move(bindings)) {}
  std::optional<Action> action_of(const Key& key) const noexcept;
  std::vector<KeyHint> hints() const;
  KeyMap without(std::initializer_list<Action> actions) const;
  // What to tell somebody who pressed another key.
  std::string explanation(const Key& pressed) const;

 private:
  std::vector<KeyBinding> bindings_;
};

KeyMap ready_keys(bool can_void_last);
// For the answer. The protocol's answer keys win: an operator's letter that is one of them moves to its capital, and
// where both are answers to the digit 0, 8 or 9 that is free.
KeyMap question_keys(const Timeline& timeline);
// The same letters during a presentation, where most of them act later, and say so; and between trials.
KeyMap presentation_keys(const Timeline& timeline);
KeyMap between_trials_keys(const Timeline& timeline);
KeyMap pause_keys();
KeyMap stopped_keys();
KeyMap missing_keys();  // while something of the rig is
KeyMap break_keys(bool over);
KeyMap instruction_keys();
KeyMap finding_keys();  // what readiness found, and other warnings to be read
KeyMap consent_keys();
KeyMap ready_to_explore_keys();
KeyMap exploring_keys();
KeyMap storage_keys();

KeyHint stop_hint();
KeyHint stop_hint_of_text();  // while text is typed, where the stop key is a letter
// Whether it is the stop key, which latches wherever no text is typed.
bool stops(const Key& key) noexcept;
// A key as a person calls it.
std::string key_name(const Key& key);
std::string key_name(char32_t character);

}  // namespace jnd
