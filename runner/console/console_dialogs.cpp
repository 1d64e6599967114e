// Dialogs of the console: what is asked before something is done, and what keys meant that came while nothing was
// asked.
#include <algorithm>
#include <array>
#include <variant>

#include <fmt/format.h>

#include "protocols/input/utf8.h"
#include "runner/console/session_console.h"
#include "runner/terminal/terminal.h"
#include "runner/words/words.h"

namespace jnd {

char32_t SessionConsole::choose(const std::string& question, const std::vector<KeyHint>& keys) {
  const TypingText no_text(*keyboard_, false);  // a page may ask
  keys_.prompt();
  std::vector<KeyHint> shown = keys;
  shown.push_back(stop_hint());
  display_->ask(question, shown);
  char32_t chosen = 0;
  const bool pausing = keys_.pause_asked();  // already: a dialog of the pause
  while (chosen == 0 && !keys_.ended() && !keys_.stopped() && keys_.pause_asked() == pausing) {
    const std::optional<Key> key = keys_.next();
    if (!key) continue;
    if (key->is(KeyName::escape)) break;
    if (key->name != KeyName::character) continue;
    const std::string pressed = to_utf8(std::u32string(1, key->character));
    if (std::none_of(keys.begin(), keys.end(), [&](const KeyHint& hint) { return hint.key == pressed; })) {
      if (!stops(*key)) display_->explain(Tone::quiet, tr("[{}] is no answer to this; Esc leaves it", key_name(*key)));
      continue;
    }
    if (!still_to_read()) chosen = key->character;
  }
  keys_.prompt();  // before the scene is seen again
  display_->asked();
  return chosen;
}

bool SessionConsole::confirm(const std::string& question) {
  if (keyboard_ == nullptr) return false;
  return choose(printable(question), {{"y", tr("yes"), true}, {"n", tr("no"), true}}) == 'y';
}

std::string SessionConsole::ask_text(const std::string& question) {
  return keys_.line(printable(question)).value_or("");
}

std::optional<OperatorRequest> SessionConsole::with_reason(Request request, const std::string& label) {
  std::optional<std::string> reason = keys_.line(label);
  // At the end of the keys what was asked for is still done, without a reason.
  if (!reason && !keys_.ended()) return std::nullopt;
  return OperatorRequest{request, reason.value_or("")};
}

// q twice ends for now.
std::optional<OperatorRequest> SessionConsole::ask_end() {
  const char32_t chosen = choose(tr("End this session?"), {{"q", tr("for now: the same command goes on with it"), true},
                                                           {"g", tr("for good: it is closed as it is"), true},
                                                           {"n", tr("no, go on"), true}});
  if (keys_.ended()) return OperatorRequest{Request::end_for_now, {}};
  if (chosen == 'q') return with_reason(Request::end_for_now, tr("Ends for now. Reason, or Enter"));
  if (chosen == 'g') return with_reason(Request::end_for_good, tr("Ends for good. Reason, or Enter (Esc: do not end)"));
  return std::nullopt;
}

std::optional<OperatorRequest> SessionConsole::request_of(const KeyBinding& key, const KeyMap& keys) {
  if (key.meaning == KeyMeaning(HelpWanted{})) help(keys);
  const Request* const request = std::get_if<Request>(&key.meaning);
  if (request == nullptr) return std::nullopt;
  if (!key.reason.empty()) return with_reason(*request, key.reason);
  switch (*request) {
    case Request::go_on:
    case Request::stopped:
      return OperatorRequest{*request, {}};
    case Request::pause:
      return with_reason(*request, tr("Pause. Reason, or Enter"));
    case Request::repeat_trial:
      return with_reason(*request, tr("It comes again later. Reason, or Enter (Esc: no)"));
    case Request::take_break:
      return with_reason(*request, tr("Break. Reason, or Enter (Esc: no break)"));
    case Request::note: {
      const std::optional<std::string> text = keys_.line(tr("Note"));
      if (!text || text->empty()) return std::nullopt;
      display_->tell(Tone::quiet, tr("note: {}", printable(*text)));
      return OperatorRequest{*request, *text};
    }
    case Request::void_last:
      if (!confirm(tr("Take back the last answer? Its trial comes again."))) return std::nullopt;
      return with_reason(*request, tr("Takes it back. Reason, or Enter (Esc: no)"));
    case Request::end_block:
      if (!confirm(tr("Give up the rest of this block? Its trials are left out."))) return std::nullopt;
      return with_reason(*request, tr("Ends the block. Reason, or Enter (Esc: no)"));
    case Request::end_for_now:
    case Request::end_for_good:
      return ask_end();
  }
  return std::nullopt;
}

// In lines; a screen shows them by itself (PromptKeys).
void SessionConsole::help(const KeyMap& keys) {
  std::vector<KeyHint> all = keys.hints();
  std::erase_if(all, [](const KeyHint& hint) { return !hint.works; });
  all.push_back({"Ctrl-C", tr("pauses; twice: ends the session safely"), true});
  std::string text;
  for (const KeyHint& hint : all) text += fmt::format("{:>8}  {}\n", "[" + hint.key + "]", hint.what);
  keys_.prompt();
  display_->scene({Tone::strong, tr("Keys"), "", text, {{tr("space"), tr("back"), true}, stop_hint()}});
}

void SessionConsole::hear_in_trial() {
  keys_.look_at_stop();
  note_in_trial(keys_.heard());
}

void SessionConsole::note_in_trial(const std::vector<Key>& keys) {
  if (keys.empty()) return;
  const KeyMap now = presentation_keys(protocol_);
  for (const Key& key : keys) {
    if (now.binding_of(key)) continue;
    const auto later = question_keys_.binding_of(key);
    const bool answer = later && std::holds_alternative<GivenAnswer>(later->meaning);
    if (answer)
      display_->explain(Tone::quiet, tr("[{}] does nothing now: nothing is asked yet", key_name(key)));
    else
      explain(now, key);
  }
  note_requests(keys, question_keys_);
}

void SessionConsole::note_requests(const std::vector<Key>& keys, const KeyMap& map) {
  constexpr std::array kLater = {Request::pause, Request::note, Request::end_for_now, Request::repeat_trial};
  for (const Key& key : keys) {
    const std::optional<KeyBinding> binding = map.binding_of(key);
    if (!binding) continue;
    const bool noted = std::any_of(noted_.begin(), noted_.end(),
                                   [&](const KeyBinding& earlier) { return earlier.meaning == binding->meaning; });
    const bool later =
        std::any_of(kLater.begin(), kLater.end(), [&](Request request) { return binding->asks(request); });
    if (later && !noted) noted_.push_back(*binding);
  }
  tell_queued();
}

void SessionConsole::tell_queued() {
  std::vector<std::string> words;
  for (const KeyBinding& key : noted_) {
    if (key.asks(Request::pause)) words.emplace_back(tr("pause after this trial"));
    if (key.asks(Request::note)) words.emplace_back(tr("note after this trial"));
    if (key.asks(Request::end_for_now)) words.emplace_back(tr("end after this trial"));
    if (key.asks(Request::repeat_trial)) words.emplace_back(tr("repeat this trial after this interval"));
  }
  display_->queued(words);
}

std::optional<OperatorRequest> SessionConsole::noted_request(const KeyMap& keys) {
  while (!noted_.empty() && !keys_.ended()) {
    const KeyBinding key = noted_.front();
    noted_.erase(noted_.begin());
    tell_queued();
    if (key.asks(Request::repeat_trial)) continue;  // its trial is over
    if (std::optional<OperatorRequest> request = request_of(key, keys)) return request;
  }
  return std::nullopt;
}

}  // namespace jnd
