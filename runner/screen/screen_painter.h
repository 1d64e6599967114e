// Frames to the terminal through ncurses, which writes what has changed only.
#pragma once

#include <memory>

#include "runner/screen/screen_layout.h"

namespace jnd {

// Where frames go. Thread rule: one thread.
class Painter {
 public:
  virtual ~Painter() = default;
  virtual bool unicode() const noexcept = 0;
  virtual int rows() const noexcept = 0;
  virtual int columns() const noexcept = 0;
  // Takes note of a new size, and of a terminal that was lent to the shell; true where all must be drawn anew.
  virtual bool changed() = 0;
  virtual void paint(const Frame& frame) = 0;
  virtual void beep() = 0;
};

// Takes the terminal's screen while it lives. One at a time.
class ScreenPainter final : public Painter {
 public:
  ScreenPainter();
  ~ScreenPainter() override;
  ScreenPainter(const ScreenPainter&) = delete;
  ScreenPainter& operator=(const ScreenPainter&) = delete;

  // Whether this terminal can show a screen at all.
  static bool possible();
  // Whether ncurses could begin; otherwise nothing is painted.
  bool works() const noexcept;
  bool unicode() const noexcept override { return unicode_; }
  int rows() const noexcept override;
  int columns() const noexcept override;
  bool changed() override;
  void paint(const Frame& frame) override;
  void beep() override;

 private:
  unsigned long attributes(const Style& style) const;

  struct Screen;  // ncurses' own
  std::unique_ptr<Screen> screen_;
  bool unicode_ = false, colours_ = false;
  int losses_ = 0;
};

}  // namespace jnd
