#include "devices/hid/buttons/button_decoder.h"

#include <algorithm>

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

}  // namespace jnd
