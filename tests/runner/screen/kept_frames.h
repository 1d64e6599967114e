// A screen that is kept instead of shown, under a clock that the test sets.
#pragma once

#include <string>
#include <vector>

#include "devices/clock.h"
#include "runner/screen/screen_painter.h"

namespace jnd::test {

// The session's clock, for the times on the screen too.
class SharedClock final : public Clock {
 public:
  explicit SharedClock(const Clock& clock) : clock_(clock) {}
  std::int64_t now_ns() const noexcept override { return clock_.now_ns(); }
  std::int64_t utc_ns() const noexcept override { return clock_.utc_ns(); }
  void sleep_until_ns(std::int64_t) noexcept override {}

 private:
  const Clock& clock_;
};

// The latest frame, as lines of text.
class KeptFrames final : public Painter {
 public:
  explicit KeptFrames(std::vector<std::string>& lines) : lines_(lines) {}
  bool unicode() const noexcept override { return true; }
  int rows() const noexcept override { return 30; }
  int columns() const noexcept override { return 100; }
  bool changed() override { return false; }
  void paint(const Frame& frame) override {
    lines_.clear();
    for (const Row& row : frame.rows) {
      std::string line;
      for (const Span& span : row) line += span.text + " ";
      lines_.push_back(line);
    }
  }
  void beep() override {}

 private:
  std::vector<std::string>& lines_;
};

}  // namespace jnd::test
