#include "runner/console/console_lines.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <fmt/format.h>
#include <unistd.h>

#include "analysis/numerics/words.h"
#include "protocols/input/utf8.h"
#include "runner/keys/interrupt.h"
#include "runner/terminal/terminal.h"
#include "runner/words/words.h"

namespace jnd {

namespace {

// Prints and shows at once: the operator reads along, also through a pipe. Where its reader has ended,
// the session ends as after a signal, and goes on when it is begun again.
template <typename... Args>
void put(fmt::format_string<Args...> format, Args&&... args) {
  const std::string text = fmt::format(format, std::forward<Args>(args)...);
  const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
  if (std::fflush(stdout) != 0 || !written) request_interrupt();
}

std::string toned(Tone tone, const std::string& text) {
  switch (tone) {
    case Tone::strong:
      return bold(text);
    case Tone::quiet:
      return dim(text);
    case Tone::warning:
      return warn(text);
    case Tone::plain:
      break;
  }
  return text;
}

// Line ends stay, and each line is indented.
void put_text(const std::string& text) {
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t to = std::min(text.find('\n', from), text.size());
    if (to > from || to < text.size()) put("  {}\n", printable(text.substr(from, to - from)));
    from = to + 1;
  }
}

void put_question(const QuestionnairePage& page) {
  const QuestionnairePage::Item& item = page.items()[page.at()];
  const Question& question = *item.question;
  put("\n{}\n", bold(printable(question.text)));
  if (page.items().size() > 1)
    put("{}\n", dim(fmt::format("  {}", tr("question {} of {}", page.at() + 1, page.items().size()))));
  if (!item.about.empty()) put("  {}\n", tr("about condition {}", printable(item.about)));
  if (question.kind == Question::Kind::rating)
    put("  {:g} = {}  ...  {:g} = {}\n", question.min, printable(question.low_label), question.max,
        printable(question.high_label));
  if (question.kind == Question::Kind::number)
    put("  {}\n", tr("a number from {:g} to {:g}", question.min, question.max));
  for (std::size_t i = 0; i < question.options.size(); ++i)
    put("  [{}] {}\n", i + 1, printable(i < question.shown.size() ? question.shown[i] : question.options[i]));
  if (question.kind == Question::Kind::confirm) put("{}\n", dim(fmt::format("  {}", tr("y once it is so"))));
  if (!question.required) put("{}\n", dim(fmt::format("  {}", tr("an empty line skips this question"))));
  if (page.at() > 0) put("{}\n", dim(fmt::format("  {}", tr("< goes back to the question before"))));
  if (!item.typed.empty())
    put("{}\n", dim(fmt::format("  {}", tr("so far: {}", printable(page.shown_reply(page.at()))))));
}

void put_review(const QuestionnairePage& page) {
  put("\n{}\n", bold(tr("Please look through the answers")));
  for (std::size_t i = 0; i < page.items().size(); ++i) {
    const QuestionnairePage::Item& item = page.items()[i];
    put("  {:>2}. {}{}: {}\n", i + 1, printable(item.question->text),
        item.about.empty() ? "" : fmt::format(" ({})", printable(item.about)), printable(page.shown_reply(i)));
  }
  put("{}\n",
      dim(fmt::format("  {}", tr("Enter saves them; the number of a question changes its answer; < goes back"))));
}

}  // namespace

std::string trial_heading(const TrialOutline& outline) {
  if (outline.practice) return tr("Practice {} of {}", outline.number, outline.total);
  return outline.at_most ? tr("Trial {} of at most {}", outline.number, outline.total)
                         : tr("Trial {} of {}", outline.number, outline.total);
}

std::string kind_banner(SessionKind kind) {
  constexpr auto kWords = words<SessionKind>(
      {{word("REAL SESSION: this counts as data"), SessionKind::real},
       {word("REHEARSAL (kind pilot: never counted as real data)"), SessionKind::pilot},
       {word("DEMONSTRATION with a simulated participant (kind simulated)"), SessionKind::simulated}});
  return std::string(translated(word_of(kWords, kind)));
}

std::string card_line(const SessionCard& card) {
  const std::string session = card.sessions > 1 ? tr(", session {} of {}", card.session, card.sessions) : "";
  const std::string group = card.group.empty() ? "" : tr(", group {}", card.group);
  return tr("participant {}{}{}, {} of {} trials done{}{}", card.participant, group, session, card.trials_done,
            card.trials_total, card.resumed ? tr("; going on with the session") : std::string(),
            card.fast ? tr("; waiting takes no time (--fast)") : std::string());
}

void LineDisplay::begin(const SessionCard& card) {
  put("{}\n{}\n{}\n", bold(card.title), warn(kind_banner(card.kind)), card_line(card));
  if (card.unblinded) put("{}\n", warn(tr("UNBLINDED: forces are shown")));
}

void LineDisplay::end(const std::string& last_words) {
  if (!last_words.empty()) put("{}\n", last_words);
}

void LineDisplay::announce(const std::string& text, bool warning) {
  put("\n{}\n", toned(warning ? Tone::warning : Tone::plain, text));
}

void LineDisplay::scene(const Scene& scene) {
  if (!scene.heading.empty()) put("\n{}", toned(scene.tone, scene.heading));
  if (!scene.beside.empty()) put("  {}", scene.beside);
  if (!scene.heading.empty()) put("\n");
  if (!scene.text.empty()) put_text(scene.text);
  keys_ = scene.keys;
  keys_again();
}

void LineDisplay::keys_again() {
  print_keys(keys_, false);
}

void LineDisplay::print_keys(const std::vector<KeyHint>& keys, bool all) const {
  std::string line;
  for (const KeyHint& hint : keys)
    if (all || hint.brief) line += fmt::format("  [{}] {}", hint.key, hint.what);
  if (!line.empty()) put("{}\n", dim(line));
}

void LineDisplay::say(CuePlace, const std::string& words, bool aloud, bool beep) {
  put("{}  {}\n", beep ? "\a" : "", aloud ? tr("say: {}", words) : words);
}

void LineDisplay::feedback(const std::string& words) {
  put("  {}\n", tr("say: {}", words));
}

void LineDisplay::tell(Tone tone, const std::string& text) {
  put("  {}\n", toned(tone, text));
}

void LineDisplay::queued(const std::vector<std::string>& what) {
  for (const std::string& one : what)
    if (std::find(queued_.begin(), queued_.end(), one) == queued_.end()) put("  {}\n", dim(tr("queued: {}", one)));
  queued_ = what;
}

void LineDisplay::alert() {
  if (is_terminal(STDOUT_FILENO)) put("\a");
}

void LineDisplay::answer(const std::string& trial, const std::string& words, const std::string&) {
  put("  {}\n", tr("saved: {}, {}", trial, words));
}

// Said every ten seconds, or every minute of a long one.
void LineDisplay::countdown(const std::string& what, double left_s, double total_s) {
  const int left = static_cast<int>(std::ceil(left_s));
  const int every = total_s > 120 ? 60 : 10;
  if (left % every != 0 || left == said_left_s_ || left_s >= total_s) return;
  said_left_s_ = left;
  put("{}\n", dim(fmt::format("  {}: {}", what, duration_text(left))));
}

void LineDisplay::countdown_over() {
  said_left_s_ = -1;
}

void LineDisplay::field(const std::string& label, const LineEditor& editor) {
  const std::string text = editor.text();
  if (!typing_) {
    put("  {}> ", label.empty() ? "" : label + " ");
    typing_ = true;
    typed_.clear();
  }
  if (!echo_ || text == typed_) return;
  const std::u32string now = code_points(text), before = code_points(typed_);
  // Columns of the last character, where that is all that is gone.
  std::size_t taken_away = 0;
  if (now.size() + 1 == before.size() && before.compare(0, now.size(), now) == 0)
    taken_away = display_width(to_utf8(before.substr(now.size())));
  if (now.size() > before.size() && now.compare(0, before.size(), before) == 0)
    put("{}", to_utf8(now.substr(before.size())));
  else if (taken_away > 0)
    for (std::size_t column = 0; column < taken_away; ++column) put("\b \b");
  else
    put("\n  > {}", text);  // changed in the middle: the whole line once more
  typed_ = text;
}

void LineDisplay::field_done() {
  typing_ = false;
  if (echo_) put("\n");
}

void LineDisplay::ask(const std::string& question, const std::vector<KeyHint>& keys) {
  put("  {}\n", bold(question));
  print_keys(keys, true);
}

void LineDisplay::page(const QuestionnairePage& page) {
  if (page.reviewing())
    put_review(page);
  else
    put_question(page);
}

}  // namespace jnd
