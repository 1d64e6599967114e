#include "runner/keys/line_editor.h"

#include <algorithm>

#include "protocols/input/utf8.h"

namespace jnd {

LineEditor::LineEditor(const std::string& utf8) : text_(code_points(utf8)), cursor_(text_.size()) {}

LineEditor::Outcome LineEditor::press(const Key& key) {
  const std::size_t before = cursor_;
  switch (key.name) {
    case KeyName::enter:
      return Outcome::done;
    case KeyName::escape:
      return Outcome::cancelled;
    case KeyName::character:
      if (text_.size() >= kLongest) return Outcome::ignored;
      text_.insert(cursor_++, 1, key.character);
      return Outcome::edited;
    case KeyName::backspace:
      if (cursor_ == 0) return Outcome::ignored;
      text_.erase(--cursor_, 1);
      return Outcome::edited;
    case KeyName::delete_:
      if (cursor_ == text_.size()) return Outcome::ignored;
      text_.erase(cursor_, 1);
      return Outcome::edited;
    case KeyName::left:
      cursor_ -= cursor_ > 0 ? 1 : 0;
      break;
    case KeyName::right:
      cursor_ = std::min(cursor_ + 1, text_.size());
      break;
    case KeyName::home:
      cursor_ = 0;
      break;
    case KeyName::end:
      cursor_ = text_.size();
      break;
    case KeyName::control:
      if (key.character != 'u' || text_.empty()) return Outcome::ignored;
      clear();
      return Outcome::edited;
    default:
      return Outcome::ignored;
  }
  return cursor_ == before ? Outcome::ignored : Outcome::edited;
}

std::string LineEditor::text() const {
  return to_utf8(text_);
}

std::string LineEditor::before_cursor() const {
  return to_utf8(text_.substr(0, cursor_));
}

void LineEditor::clear() noexcept {
  text_.clear();
  cursor_ = 0;
}

}  // namespace jnd
