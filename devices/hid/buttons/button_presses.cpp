#include "devices/hid/buttons/button_presses.h"

#include <algorithm>
#include <utility>

namespace jnd {

void ButtonChanges::add(const ButtonChange& change) noexcept {
  if (count_ == changes_.size()) return;  // cannot be: a button settles once and changes once a report
  std::size_t place = count_++;
  for (; place > 0 && changes_[place - 1].time_ns > change.time_ns; --place) changes_[place] = changes_[place - 1];
  changes_[place] = change;
}

void ButtonDecoder::opened(std::int64_t now_ns) noexcept {
  states_ = {};
  fresh_ = true;
  opened_ns_ = now_ns;
}

bool ButtonDecoder::speaks_of(std::span<const std::uint8_t> report) const noexcept {
  return report.size() == static_cast<std::size_t>(mapping_.report_bytes) &&
         (!mapping_.report_id || report[0] == *mapping_.report_id);
}

bool ButtonDecoder::bouncing(const State& state, std::int64_t now_ns) const noexcept {
  return state.changed && now_ns - state.accepted_ns <= std::int64_t{mapping_.debounce_ms} * 1'000'000;
}

void ButtonDecoder::settle(std::int64_t now_ns, ButtonChanges& changes) noexcept {
  for (const MappedButton& button : mapping_.buttons) {
    State& state = states_[static_cast<std::size_t>(button.meaning)];
    if (state.raw == state.accepted || bouncing(state, now_ns)) continue;
    state.accepted = state.raw;
    state.accepted_ns = state.raw_ns;
    changes.add({button.meaning, state.accepted, false, state.raw_ns});
  }
}

ButtonChanges ButtonDecoder::settle(std::int64_t now_ns) noexcept {
  ButtonChanges changes;
  settle(now_ns, changes);
  return changes;
}

ButtonChanges ButtonDecoder::feed(std::span<const std::uint8_t> report, std::int64_t time_ns) noexcept {
  ButtonChanges changes;
  settle(time_ns, changes);
  if (!speaks_of(report)) return changes;
  const bool opening = fresh_ && time_ns - opened_ns_ <= kOpening_ns;
  fresh_ = false;
  for (const MappedButton& button : mapping_.buttons) {
    State& state = states_[static_cast<std::size_t>(button.meaning)];
    const bool pressed = is_pressed(button, report).value_or(state.raw);
    if (pressed == state.raw) continue;
    state.raw = pressed;
    state.raw_ns = time_ns;
    changes.stops = changes.stops || (pressed && button.meaning == ButtonMeaning::stop);
    if (pressed == state.accepted || bouncing(state, time_ns)) continue;
    state.accepted = pressed;
    state.accepted_ns = time_ns;
    state.changed = true;
    changes.add({button.meaning, pressed, opening, time_ns});
  }
  return changes;
}

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
