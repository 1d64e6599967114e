// From the reports of a button box to presses and releases, and to the presses that answer a question.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "devices/hid/buttons/button_mapping.h"
#include "protocols/vocabulary.h"

namespace jnd {

struct ButtonChange {
  ButtonMeaning meaning = ButtonMeaning::same;
  bool pressed = false;
  bool found_down = false;   // it was down already when the box was opened: no press
  std::int64_t time_ns = 0;  // of the first edge
};

// In the order of their times.
class ButtonChanges {
 public:
  void add(const ButtonChange& change) noexcept;
  const ButtonChange* begin() const noexcept { return changes_.data(); }
  const ButtonChange* end() const noexcept { return changes_.data() + count_; }
  std::size_t size() const noexcept { return count_; }

  // A stop button went down, be it a bounce: a stop does not wait for certainty.
  bool stops = false;

 private:
  std::array<ButtonChange, 2 * kButtonMeanings> changes_{};  // what has settled, and the report's own
  std::size_t count_ = 0;
};

// Pure: time comes with the reports. A change counts at its first edge; what the same button does within debounce_ms
// after it is bounce. Where bounce ends in the other state, as of a tap that is shorter, that is a change too: of the
// time of its own last edge, found at the next report or settle(). Nothing allocates or throws.
class ButtonDecoder {
 public:
  // A button that is down in a report so soon after opening was down before: a box that only reports changes says
  // nothing then. ns.
  static constexpr std::int64_t kOpening_ns = 300'000'000;

  explicit ButtonDecoder(const ButtonMapping& mapping) : mapping_(mapping) {}

  // The box was opened: whatever was known of its buttons is forgotten.
  void opened(std::int64_t now_ns) noexcept;
  ButtonChanges feed(std::span<const std::uint8_t> report, std::int64_t time_ns) noexcept;
  // Time has passed without a report.
  ButtonChanges settle(std::int64_t now_ns) noexcept;
  // By the latest report, bounce or not.
  bool is_down(ButtonMeaning meaning) const noexcept { return states_[static_cast<std::size_t>(meaning)].raw; }
  // Whether the report is one that the mapping speaks of; others, as of a numbered one of the same box, change nothing.
  bool speaks_of(std::span<const std::uint8_t> report) const noexcept;

 private:
  struct State {
    bool accepted = false, raw = false;
    bool changed = false;                      // at all: since then accepted_ns says when
    std::int64_t accepted_ns = 0, raw_ns = 0;  // times of the latest changes
  };
  bool bouncing(const State& state, std::int64_t now_ns) const noexcept;
  void settle(std::int64_t now_ns, ButtonChanges& changes) noexcept;

  ButtonMapping mapping_;
  std::array<State, kButtonMeanings> states_{};  // by meaning
  bool fresh_ = true;                            // no report since the opening
  std::int64_t opened_ns_ = 0;
};

// Which presses of the two answer buttons answer a question.

struct ButtonAnswer {
  int said = 0;              // the first answer of the task, or its second
  std::int64_t time_ns = 0;  // of the press
};

enum class AnswerTrouble {
  none,
  two_at_once,  // both buttons: neither counts
  held          // a button was down before the question: no answer, until it is let go
};

// Pure: time comes with the presses. The first press after the question answers it, unless the other button is down
// with it: pressed since before, before the answer is taken, or less than kTogether_ns apart. Nothing allocates or
// throws.
class ButtonAnswers {
 public:
  // Two presses so near each other were one movement of both hands, ns.
  static constexpr std::int64_t kTogether_ns = 30'000'000;

  // A question is shown; what was pressed before does not answer it.
  void ask(std::int64_t now_ns) noexcept;
  // In the order of their times.
  void change(const ButtonChange& change) noexcept;
  // The box has gone: nothing is known to be down. An answer that was pressed stays one.
  void forget() noexcept;
  // The answer, once: from kTogether_ns after the press on.
  std::optional<ButtonAnswer> take(std::int64_t now_ns) noexcept;
  // A press that take() may still give.
  const std::optional<ButtonAnswer>& pending() const noexcept { return pending_; }
  // The latest trouble, once.
  AnswerTrouble trouble() noexcept;

 private:
  struct Button {
    bool down = false, was_pressed = false;
    std::int64_t pressed_ns = 0;
  };

  std::array<Button, 2> buttons_{};  // of the first answer, of the second
  bool asking_ = false;
  std::int64_t asked_ns_ = 0;
  std::optional<ButtonAnswer> pending_;
  bool pending_held_ = false;  // since the press that is pending
  AnswerTrouble trouble_ = AnswerTrouble::none;
};

}  // namespace jnd
