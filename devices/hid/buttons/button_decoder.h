// From the reports of a button box to presses and releases.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "devices/hid/buttons/button_mapping.h"

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

}  // namespace jnd
