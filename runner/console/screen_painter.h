// Frames to the terminal through ncurses, which writes what has changed only.
#pragma once

#include <memory>

#include "runner/console/screen_layout.h"

namespace jnd {

// Takes the terminal's screen while it lives. One at a time; thread rule: one thread.
class ScreenPainter {
 public:
  ScreenPainter();
  ~ScreenPainter();
  ScreenPainter(const ScreenPainter&) = delete;
  ScreenPainter& operator=(const ScreenPainter&) = delete;

  // Whether this terminal can show a screen at all.
  static bool possible();
  // Whether ncurses could begin; otherwise nothing is painted.
  bool works() const noexcept;
  bool unicode() const noexcept { return unicode_; }
  int rows() const noexcept;
  int columns() const noexcept;
  // Takes note of a new size, and of a terminal that was lent to the shell; true where all must be drawn anew.
  bool changed();
  void paint(const Frame& frame);
  void beep();

 private:
  unsigned long attributes(const Style& style) const;

  struct Screen;  // ncurses' own
  std::unique_ptr<Screen> screen_;
  bool unicode_ = false, colours_ = false;
  int continuations_ = 0;
};

}  // namespace jnd
