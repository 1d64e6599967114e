// What the operator's keys do, by what the session waits for.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "protocols/protocol.h"
#include "protocols/vocabulary.h"
#include "runner/keys/key_parser.h"
#include "runner/session/session_view.h"

namespace jnd {

// The page of all keys.
struct HelpWanted {
  bool operator==(const HelpWanted&) const = default;
};

// An answer to a trial, as Answer has it.
struct GivenAnswer {
  int said = 0, sureness = 0;
  bool operator==(const GivenAnswer&) const = default;
};

// What a key means: what the operator asks for, in the words of the session; an answer to a trial; or help. The stop key
// means Request::stopped: the keyboard's own thread has stopped the devices already. Where a page is a question of its own,
// go_on is yes and an end is no.
using KeyMeaning = std::variant<Request, GivenAnswer, HelpWanted>;

struct KeyHint {
  std::string key;      // as printed: "space", "p", "Enter"
  std::string what;     // what it does
  bool brief = true;    // also where there is room for the most important keys only
  bool stop = false;    // shown at every size
  bool works = true;    // otherwise it stands in its place, and does nothing here
  bool place = false;   // one of the operator's own, which have the same place in every scene
  std::string label{};  // a shorter `what`, for the screen; empty: none
};

struct KeyBinding {
  char32_t key = 0;  // ' ' is also Enter
  KeyMeaning meaning = Request::go_on;
  std::string what{};
  bool brief = true;
  std::string reason{};   // how it asks for the operator's reason; empty: as usual
  std::string label{};    // KeyHint::label
  std::string why_not{};  // why it does nothing here; empty: it works
  bool place = false;     // KeyHint::place

  bool asks(Request request) const noexcept { return meaning == KeyMeaning(request); }
};

class KeyMap {
 public:
  explicit KeyMap(std::vector<KeyBinding> bindings) : bindings_(std::move(bindings)) {}
  // None of one that does nothing here.
  std::optional<KeyBinding> binding_of(const Key& key) const;
  std::vector<KeyHint> hints() const;
  // What the operator is told who pressed another key.
  std::string explanation(const Key& pressed) const;

 private:
  std::vector<KeyBinding> bindings_;
};

// What was answered, in words: "different", "second, 2 of 3 sure", "12.5".
std::string answer_text(const Answer& answer, const TaskSpec& task);

KeyMap ready_keys(bool can_void_last);
// For the answer. The protocol's answer keys win: an operator's letter that is one of them moves to its capital, and
// where both are answers to the digit 0, 8 or 9 that is free.
KeyMap question_keys(const TaskSpec& task);
// Until the participant has what is to be handed over.
KeyMap hand_over_keys(const TaskSpec& task);
// The same letters during a presentation, where most of them act later, and say so; and between trials.
KeyMap presentation_keys(const Protocol& protocol);
KeyMap between_trials_keys(const TaskSpec& task);
KeyMap pause_keys();
KeyMap stopped_keys();
KeyMap missing_keys();  // while something of the rig is
KeyMap break_keys(bool over);
KeyMap instruction_keys();
KeyMap finding_keys();  // what readiness found, and other warnings to be read
KeyMap consent_keys();
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
