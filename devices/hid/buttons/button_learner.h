// Finds out, from the reports of a box whose buttons are pressed on request, which bits mean which button.
//
// A second without touching shows what changes by itself (axes, counters). Then each button is pressed and held, and
// let go, twice. Of a byte that took exactly two values in that time, the one while held and the other while not, the
// bits that changed are the button. Whatever moved gradually, flickered, or was not the same the second time is not.
#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "devices/hid/buttons/button_mapping.h"

namespace jnd {

struct LearnerSetup {
  HidInfo info;
  bool numbered = false;  // the first byte of a report is its number
  bool with_stop = false;
  int debounce_ms = 10;
};

// Pure: time comes with the reports and with look(). Thread rule: one thread.
class ButtonLearner {
 public:
  // Times, ns: hands off, since something new changed by itself; from the last bit that began to move to "let go"; the
  // same of the release; without a release.
  static constexpr std::int64_t kQuiet_ns = 1'000'000'000, kHold_ns = 1'000'000'000, kReleased_ns = 800'000'000,
                                kNoRelease_ns = 6'000'000'000;
  static constexpr int kMostAttempts = 4;  // a button

  ButtonLearner(const LearnerSetup& setup, std::int64_t now_ns);

  void report(std::span<const std::uint8_t> bytes, std::int64_t time_ns);
  void look(std::int64_t now_ns);  // time has passed

  // What is to be told to the person now, since the last call; a line each.
  std::vector<std::string> take_words();
  bool done() const noexcept { return phase_ == Phase::done; }
  bool refused() const noexcept { return phase_ == Phase::refused; }
  // Once it is done.
  ButtonMapping mapping() const;

 private:
  enum class Phase { quiet, press, hold, let_go, released, done, refused };
  using Bytes = std::vector<std::uint8_t>;
  // Reports of one number.
  struct Stream {
    Bytes latest, noise, restless;  // bits that change by themselves; and those that did not keep still this time
    Bytes rest;                     // at the end of the quiet second; empty where there was no report
    std::vector<std::array<std::optional<std::int64_t>, 8>> moved_ns;  // of each bit, since it was asked for
    std::vector<std::bitset<256>> seen;  // values of each byte since the button's first press was asked for
    Bytes held, released;                // of the first press
    Bytes held_again, released_again;    // of the second
    bool move(std::size_t byte, std::uint8_t changed, std::int64_t now_ns);
    bool still(std::size_t byte) const;  // as it was before the press, but for what changes by itself
    std::uint8_t steady(std::size_t byte) const { return static_cast<std::uint8_t>(~(noise[byte] | restless[byte])); }
  };
  struct Found {
    MappedButton button;
    int report_id = 0;
    std::uint8_t held_value = 0;  // of its byte
    std::size_t report_bytes = 0;
  };

  ButtonMeaning wanted() const noexcept { return wanted_[learnt_.size()]; }
  void say(const std::string& words) { words_.push_back(words); }
  void enter(Phase phase, std::int64_t now_ns);
  void ask_press(std::int64_t now_ns);
  void begin_attempt(std::int64_t now_ns);
  void fail_attempt(const std::string& why, std::int64_t now_ns);
  void held(std::int64_t now_ns);
  void let_go(std::int64_t now_ns);
  void judge(std::int64_t now_ns);
  std::vector<Found> candidates() const;
  std::optional<Found> candidate(int report_id, const Stream& stream, std::size_t byte) const;
  std::string objection(const Found& found) const;
  void accept(const Found& found, std::int64_t now_ns);
  bool keyboard_array(const Stream& stream, std::size_t byte) const;

  LearnerSetup setup_;
  std::vector<ButtonMeaning> wanted_;
  Phase phase_ = Phase::quiet;
  std::int64_t began_ns_ = 0, since_ns_ = 0;
  bool again_ = false;  // the second press
  int attempts_ = 0;
  std::map<int, Stream> streams_;  // by report number; 0 where there are none
  std::vector<Found> learnt_;
  std::vector<std::string> words_;
};

// Whether reports of such a device are numbered, by its report descriptor.
bool numbers_reports(std::span<const std::uint8_t> report_descriptor) noexcept;

}  // namespace jnd
