// Which presses of the two answer buttons answer a question.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "devices/hid/buttons/button_decoder.h"
#include "protocols/vocabulary.h"

namespace jnd {

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
