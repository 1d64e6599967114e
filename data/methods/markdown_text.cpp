#include "data/methods/markdown_text.h"

#include <cstddef>

namespace jnd {

namespace {

bool is_alphanumeric(char character) noexcept {
  return (character >= '0' && character <= '9') || (character >= 'a' && character <= 'z') ||
         (character >= 'A' && character <= 'Z');
}

// before and after: the neighbours; '\0' at an end of the text.
bool is_mark(char character, char before, char after) noexcept {
  switch (character) {
    case '\\':
    case '`':
    case '*':
    case '[':
    case ']':
    case '~':
    case '|':
      return true;
    case '_':  // within a word it is no emphasis: no_sensitivity stays as it is
      return !(is_alphanumeric(before) && is_alphanumeric(after));
    case '<':  // a tag or an address
      return is_alphanumeric(after) || after == '/' || after == '!' || after == '?';
    case '&':  // an entity
      return is_alphanumeric(after) || after == '#';
    default:
      return false;
  }
}

}  // namespace

std::string markdown_text(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\n' || text[i] == '\r') {
      out += ' ';
      continue;
    }
    if (is_mark(text[i], i > 0 ? text[i - 1] : '\0', i + 1 < text.size() ? text[i + 1] : '\0')) out += '\\';
    out += text[i];
  }
  return out;
}

std::string list_of(const std::vector<std::string>& items) {
  std::string text;
  for (std::size_t i = 0; i < items.size(); ++i)
    text += (i == 0 ? "" : i + 1 == items.size() ? " and " : ", ") + items[i];
  return text;
}

const char* plural(std::size_t n) noexcept {
  return n == 1 ? "" : "s";
}

std::string capitalised(std::string text) {
  const auto lower = [&](std::size_t at) { return at < text.size() && text[at] >= 'a' && text[at] <= 'z'; };
  if (lower(0) && lower(1)) text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text;
}

}  // namespace jnd
