#include "runner/keys/line_editor.h"

#include <algorithm>

namespace jnd {

namespace {

constexpr char32_t kReplacement = 0xfffd;

void append_utf8(std::string& to, char32_t c) {
  const auto byte = [&](char32_t bits) { to += static_cast<char>(static_cast<unsigned char>(bits)); };
  if (c < 0x80) {
    byte(c);
  } else if (c < 0x800) {
    byte(0xc0 | (c >> 6));
    byte(0x80 | (c & 0x3f));
  } else if (c < 0x10000) {
    byte(0xe0 | (c >> 12));
    byte(0x80 | ((c >> 6) & 0x3f));
    byte(0x80 | (c & 0x3f));
  } else {
    byte(0xf0 | (c >> 18));
    byte(0x80 | ((c >> 12) & 0x3f));
    byte(0x80 | ((c >> 6) & 0x3f));
    byte(0x80 | (c & 0x3f));
  }
}

}  // namespace

std::string to_utf8(const std::u32string& text) {
  std::string utf8;
  for (const char32_t c : text) append_utf8(utf8, c);
  return utf8;
}

std::u32string code_points(const std::string& utf8) {
  std::u32string text;
  for (std::size_t i = 0; i < utf8.size();) {
    const auto first = static_cast<unsigned char>(utf8[i++]);
    if (first < 0x80) {
      text += first;
      continue;
    }
    const int more = first >= 0xf0 && first <= 0xf4 ? 3 : first >= 0xe0 ? 2 : first >= 0xc2 ? 1 : 0;
    static constexpr char32_t kLeast[] = {0, 0x80, 0x800, 0x10000};
    char32_t c = first & (0x3fU >> more);
    int got = 0;
    while (got < more && i < utf8.size() && (static_cast<unsigned char>(utf8[i]) & 0xc0) == 0x80) {
      c = (c << 6) | (static_cast<unsigned char>(utf8[i++]) & 0x3fU);
      ++got;
    }
    const bool whole =
        more > 0 && first <= 0xf4 && got == more && c >= kLeast[more] && c <= 0x10ffff && (c < 0xd800 || c > 0xdfff);
    text += whole ? c : kReplacement;
  }
  return text;
}

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
