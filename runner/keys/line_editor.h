// A line of text as it is typed: notes, reasons, answers. Pure: keys in, text out.
#pragma once

#include <cstddef>
#include <string>

#include "runner/keys/key_parser.h"

namespace jnd {

class LineEditor {
 public:
  static constexpr std::size_t kLongest = 1000;  // characters

  enum class Outcome { edited, ignored, done, cancelled };

  LineEditor() = default;
  explicit LineEditor(const std::string& utf8);

  // Enter: done; Escape: cancelled. Characters beyond kLongest are ignored.
  Outcome press(const Key& key);
  std::string text() const;           // UTF-8
  std::string before_cursor() const;  // UTF-8
  bool empty() const noexcept { return text_.empty(); }
  void clear() noexcept;

 private:
  std::u32string text_;
  std::size_t cursor_ = 0;
};

}  // namespace jnd
