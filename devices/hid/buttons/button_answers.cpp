#include "devices/hid/buttons/button_answers.h"

#include <utility>

namespace jnd {

void ButtonAnswers::ask(std::int64_t now_ns) noexcept {
  asking_ = true;
  asked_ns_ = now_ns;
  pending_.reset();
  trouble_ = buttons_[0].down || buttons_[1].down ? AnswerTrouble::held : AnswerTrouble::none;
}

void ButtonAnswers::change(const ButtonChange& change) noexcept {
  if (change.meaning == ButtonMeaning::stop) return;
  const bool same = change.meaning == ButtonMeaning::same;
  const int said = same ? 0 : 1;
  Button& button = buttons_[same ? 0 : 1];
  const Button& other = buttons_[same ? 1 : 0];
  button.down = change.pressed;
  if (!change.pressed) {
    if (pending_ && pending_->said == said) pending_held_ = false;
    return;
  }
  if (change.found_down) {
    trouble_ = AnswerTrouble::held;
    return;
  }
  button.was_pressed = true;
  button.pressed_ns = change.time_ns;
  if (!asking_ || change.time_ns < asked_ns_) return;
  if (!pending_) {
    const bool together = other.down || (other.was_pressed && change.time_ns - other.pressed_ns <= kTogether_ns);
    if (together)
      trouble_ = AnswerTrouble::two_at_once;
    else
      pending_ = ButtonAnswer{said, change.time_ns};
    pending_held_ = !together;
  } else if (pending_->said != said && (pending_held_ || change.time_ns - pending_->time_ns <= kTogether_ns)) {
    pending_.reset();
    trouble_ = AnswerTrouble::two_at_once;
  }
}

void ButtonAnswers::forget() noexcept {
  buttons_ = {};
}

std::optional<ButtonAnswer> ButtonAnswers::take(std::int64_t now_ns) noexcept {
  if (!pending_ || now_ns - pending_->time_ns <= kTogether_ns) return std::nullopt;
  asking_ = false;
  return std::exchange(pending_, std::nullopt);
}

AnswerTrouble ButtonAnswers::trouble() noexcept {
  return std::exchange(trouble_, AnswerTrouble::none);
}

}  // namespace jnd
