#include "runner/console/console_input.h"

#include <fmt/format.h>

#include "devices/clock.h"
#include "protocols/input/utf8.h"
#include "runner/words/words.h"

namespace jnd {

namespace {
constexpr double kPoll_s = 0.02;
}  // namespace

bool PromptKeys::stopped() const noexcept {
  if (stop_ == nullptr || seeing_to_stop_) return false;
  const StopSource source = stop_->source();
  return source == StopSource::key || source == StopSource::button;
}

void PromptKeys::look_at_stop() {
  if (stop_ == nullptr || stop_shown_) return;
  const StopSource source = stop_->source();
  if (source == StopSource::key || source == StopSource::button) show_stop(std::string(to_string(source)));
}

void PromptKeys::show_stop(const std::string& by) {
  if (stop_shown_) return;
  stop_shown_ = true;
  display_.stopped(StopShown{std::string(translated(by)), SteadyClock().now_ns()});
}

void PromptKeys::stop_cleared() {
  stop_shown_ = false;
  display_.stopped(std::nullopt);
}

// Where the keys of this screen are shown, any key takes them away again.
bool PromptKeys::changes_view(const Key& key) {
  if (display_.help(false)) return !stops(key);
  if (key.name == KeyName::control && key.character == 'l') {
    display_.enlarge();
    return true;
  }
  return key.is(U'?') && display_.help(true);
}

std::vector<Key> PromptKeys::heard() {
  look_at_stop();
  std::vector<Key> keys = drain();
  std::erase_if(keys, [&](const Key& key) { return changes_view(key) || display_.scroll(key.name); });
  return keys;
}

std::vector<Key> PromptKeys::drain() {
  std::vector<Key> keys;
  if (keyboard_ == nullptr || !keyboard_->is_terminal()) return keys;  // a pipe's writer cannot wait for prompts
  keyboard_->catch_up();
  while (const std::optional<Key> key = keyboard_->press(0)) {
    held_.hear(*key);
    keys.push_back(*key);
  }
  return keys;
}

std::vector<Key> PromptKeys::prompt() {
  std::vector<Key> early = drain();
  held_.prompt(SteadyClock().now_ns());
  told_to_let_go_ = false;
  return early;
}

std::optional<Key> PromptKeys::next(bool text) {
  look_at_stop();
  display_.refresh();
  if (keyboard_ == nullptr) return std::nullopt;
  const std::optional<Key> key = keyboard_->press(kPoll_s);
  look_at_stop();  // before what it ends is written down
  if (!keyboard_->is_terminal()) return key;
  if (!key) {
    if (told_to_let_go_ && !held_.maybe_down(SteadyClock().now_ns())) {
      told_to_let_go_ = false;
      display_.keys_again();
    }
    return std::nullopt;
  }
  const Heard heard = held_.hear(*key);
  if (heard == Heard::early) return std::nullopt;
  if (!(text && key->name == KeyName::character) && changes_view(*key)) return std::nullopt;
  if (heard == Heard::counts || (text && key->name == KeyName::character)) return key;
  if (!told_to_let_go_)
    display_.explain(Tone::warning, tr("{} was down already: let go of it, then press it again", key_name(*key)));
  told_to_let_go_ = true;
  return std::nullopt;
}

std::optional<std::string> PromptKeys::line(const std::string& label, const std::string& initial) {
  if (keyboard_ == nullptr || ended()) return std::nullopt;
  if (keyboard_->is_terminal()) return edited_line(label, initial);
  display_.field(label, LineEditor());
  std::optional<std::string> text = keyboard_->line(interrupts_);
  display_.field_done();
  if (!text) return std::nullopt;
  // What no key could have typed does not come in through a pipe either.
  std::u32string characters = code_points(*text);
  std::erase_if(characters, [](char32_t c) { return c < 0x20 || (c >= 0x7f && c < 0xa0); });
  if (characters.size() > LineEditor::kLongest) characters.resize(LineEditor::kLongest);
  return to_utf8(characters);
}

std::optional<std::string> PromptKeys::edited_line(const std::string& label, const std::string& initial) {
  prompt();
  const TypingText typing(*keyboard_);
  LineEditor editor(initial);
  display_.field(label, editor);
  std::optional<std::string> text;
  const bool pausing = pause_asked();  // already: a note during the pause
  while (!ended() && !stopped() && pause_asked() == pausing) {
    const std::optional<Key> key = next(true);
    if (!key) continue;
    const LineEditor::Outcome outcome = editor.press(*key);
    if (outcome == LineEditor::Outcome::cancelled) break;
    if (outcome == LineEditor::Outcome::done) {
      text = editor.text();
      break;
    }
    if (outcome == LineEditor::Outcome::edited) display_.field(label, editor);
  }
  prompt();  // before the scene is seen again
  display_.field_done();
  return text;
}

}  // namespace jnd
