#include "runner/console.h"

#include <cmath>
#include <cstdio>

#include <fmt/format.h>

#include "runner/interrupt.h"
#include "runner/terminal.h"

namespace jnd {

namespace {
constexpr double kPoll_s = 0.05;  // how often a wait looks at the interrupt latch

// Prints and shows at once: the operator reads along, also through a pipe.
template <typename... Args>
void say(fmt::format_string<Args...> format, Args&&... args) {
  fmt::print(format, std::forward<Args>(args)...);
  std::fflush(stdout);
}
}  // namespace

bool ConsoleView::wait_for_space() {
  if (keyboard_ == nullptr) return !interrupt_requested();
  while (!interrupt_requested()) {
    const std::optional<char> key = keyboard_->key(kPoll_s);
    if (keyboard_->at_end()) return false;
    if (!key) continue;
    if (*key == ' ' || *key == '\n') return true;
    if (*key == 'q') return false;
    say("  [space] goes on, [q] ends the session for now\n");
  }
  return false;
}

bool ConsoleView::ready(const TrialOutline& outline) {
  if (keyboard_ != nullptr) keyboard_->forget_early_keys();
  if (outline.practice)
    say("\n{}", bold(fmt::format("Practice {} of {}", outline.number, outline.total)));
  else
    say("\n{}",
        bold(fmt::format("Trial {} of {}{}", outline.number, outline.at_most ? "at most " : "", outline.total)));
  say("  condition {}", outline.condition_code);
  if (!outline.practice)
    say("  block {} of {}  about {} left", outline.block, outline.blocks, duration_text(outline.time_left_s));
  if (outline.attempt > 1) say("  (attempt {})", outline.attempt);
  say("\n");
  if (keyboard_ != nullptr)
    say("{}\n", dim("  [space] when the participant is ready, [x] stops the devices at any time, [q] to end for now"));
  return wait_for_space();
}

void ConsoleView::cue(CuePlace place, const CueSignal& cue) {
  static constexpr const char* kDefault[] = {"first sphere", "second sphere", "same or different?"};
  const auto index = static_cast<std::size_t>(place);
  say("{}  {}\n", cue.kind == "sound" ? "\a" : "", cue.say.empty() ? kDefault[index] : "say: " + printable(cue.say));
}

void ConsoleView::saved(const TrialOutline&, const Answer& answer) {
  say("  saved: {}, {:.2f} s\n", to_string(answer.judgement), answer.response_time_s);
}

void ConsoleView::voided(const TrialOutline&, const std::string& reason, bool will_repeat) {
  say("  {} ({}); {}\n", warn("not counted"), reason,
      will_repeat ? "it comes again at the end of this block" : "its attempts are used up");
}

bool ConsoleView::recover(const std::string& stopped_by) {
  say("\n{}\n", warn(fmt::format("STOPPED ({}). The devices are at rest.", stopped_by)));
  if (keyboard_ == nullptr) return false;
  say("  See to the participant and the devices. This trial comes again later.\n");
  keyboard_->forget_early_keys();
  say("{}\n", dim("  [c] clears the stop and goes on, [q] ends the session for now"));
  while (!interrupt_requested()) {
    const std::optional<char> key = keyboard_->key(kPoll_s);
    if (keyboard_->at_end() || key == 'q') return false;
    if (key == 'c') return true;
    if (key) say("  only [c] clears the stop; [q] ends the session\n");
  }
  return false;
}

void ConsoleView::feedback(bool correct) {
  say("  say: {}\n", correct ? "that was right" : "that was not right");
}

void ConsoleView::practice_over(int rounds, double share_correct, bool passed) {
  say("\nPractice is over after {} round{}: {:.0f} % right{}.\n", rounds, rounds == 1 ? "" : "s", 100 * share_correct,
      passed ? "" : ", below the protocol's criterion; this is in the log");
}

void ConsoleView::break_begins(const Break& pause) {
  say("\n{} of at least {}. {}\n", bold("Break"), duration_text(pause.duration_s),
      pause.say.empty() ? "" : "Say: " + printable(pause.say));
}

bool ConsoleView::break_over(const Break& pause) {
  clock_.sleep_until_ns(clock_.now_ns() + static_cast<std::int64_t>(pause.duration_s * 1e9));
  if (keyboard_ != nullptr) {
    keyboard_->forget_early_keys();
    say("{}\n", dim("  the break may end: [space] goes on"));
  }
  return wait_for_space();
}

std::optional<Answer> KeyboardResponder::judge(const TrialQuestion& question) {
  const Timeline& timeline = protocol_.timeline;
  keyboard_.forget_early_keys();
  say("{}\n",
      dim(fmt::format("  [{}] same  [{}] different  [q] end for now", timeline.key_same, timeline.key_different)));
  const std::int64_t asked = clock_.now_ns();
  while (!interrupt_requested()) {
    const double waited = static_cast<double>(clock_.now_ns() - asked) * 1e-9;
    if (waited > question.time_out_s) return std::nullopt;
    const std::optional<KeyPress> pressed = keyboard_.press(kPoll_s);
    const std::int64_t now = clock_.now_ns(), steady_now = SteadyClock().now_ns();
    if (keyboard_.at_end() || (pressed && pressed->key == 'q')) request_interrupt();
    if (!pressed || pressed->key == 'q') continue;
    if (pressed->key == kStopKey) return std::nullopt;  // the latch is set: no answer counts
    // The time of the key, not of its being noticed here.
    const double response_time = static_cast<double>(now - asked - (steady_now - pressed->time_ns)) * 1e-9;
    if (pressed->key == timeline.key_same) return Answer{Judgement::same, entered_by_, response_time};
    if (pressed->key == timeline.key_different) return Answer{Judgement::different, entered_by_, response_time};
    say("  that key is no answer: [{}] is same, [{}] is different\n", timeline.key_same, timeline.key_different);
  }
  return std::nullopt;
}

namespace {

// A choice may be typed as its number.
std::string chosen(const Question& question, const std::string& text) {
  if (question.kind != Question::Kind::choice) return text;
  for (std::size_t i = 0; i < question.options.size(); ++i)
    if (text == std::to_string(i + 1)) return question.options[i];
  return text;
}

// What is wrong with a reply, or an empty text.
std::string mistake_in(const Question& question, const std::string& text) {
  if (question.kind == Question::Kind::choice) {
    for (const std::string& option : question.options)
      if (option == text) return "";
    return "please type the number of an answer";
  }
  if (question.kind == Question::Kind::text) return "";
  std::size_t used = 0;
  double value = 0;
  try {
    value = std::stod(text, &used);
  } catch (const std::exception&) {
    used = 0;
  }
  if (used == 0 || used != text.size() || !std::isfinite(value)) return "please type a number";
  if (value < question.min || value > question.max)
    return fmt::format("please stay within {} to {}", question.min, question.max);
  if (question.kind == Question::Kind::rating && value != std::floor(value)) return "please type a whole number";
  return "";
}

}  // namespace

std::optional<std::string> KeyboardResponder::reply(const Question& question, int condition) {
  say("\n{}\n", bold(printable(question.text)));
  if (condition >= 0)
    say("  about condition {}\n", printable(protocol_.conditions[static_cast<std::size_t>(condition)].label));
  if (question.kind == Question::Kind::rating)
    say("  {:g} = {}  ...  {:g} = {}\n", question.min, printable(question.low_label), question.max,
        printable(question.high_label));
  for (std::size_t i = 0; i < question.options.size(); ++i) say("  [{}] {}\n", i + 1, printable(question.options[i]));
  if (!question.required) say("{}\n", dim("  an empty line skips this question"));
  while (!interrupt_requested()) {
    say("  > ");
    const std::optional<std::string> line = keyboard_.line();
    if (!line) {
      if (keyboard_.at_end()) request_interrupt();
      return std::nullopt;
    }
    if (line->empty() && !question.required) return std::nullopt;
    const std::string text = chosen(question, *line);
    const std::string mistake = mistake_in(question, text);
    if (mistake.empty() && !text.empty()) return text;
    say("  {}\n", mistake.empty() ? "please type an answer" : mistake);
  }
  return std::nullopt;
}

}  // namespace jnd
