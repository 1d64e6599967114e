#include "runner/screen/screen_text.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "protocols/input/utf8.h"
#include "runner/keys/line_editor.h"
#include "runner/terminal/terminal.h"

namespace jnd {

namespace {

struct Range {
  char32_t first, last;
};
// C0 and C1 controls, and what turns the direction of writing.
constexpr std::array kUnsafe = {Range{0, 0x1f},        Range{0x7f, 0x9f},     Range{0x200e, 0x200f},
                                Range{0x2028, 0x202e}, Range{0x2066, 0x2069}, Range{0xfeff, 0xfeff}};

template <std::size_t N>
bool within(const std::array<Range, N>& ranges, char32_t c) {
  for (const Range& range : ranges)
    if (c >= range.first && c <= range.last) return true;
  return false;
}

// Most text: a column a byte.
bool plain_ascii(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return c >= ' ' && c <= '~'; });
}

// Lines and blocks take a column too.
constexpr char32_t kLines = 0x2500, kAfterBlocks = 0x25a0;

int width(char32_t c) {
  return static_cast<int>(display_width(to_utf8(std::u32string(1, c))));
}

int width(const std::u32string& text) {
  const auto simple = [](char32_t c) { return (c >= U' ' && c <= U'~') || (c >= kLines && c < kAfterBlocks); };
  if (std::all_of(text.begin(), text.end(), simple)) return static_cast<int>(text.size());
  return static_cast<int>(display_width(to_utf8(text)));
}

// As many characters as fit.
std::size_t fitting(const std::u32string& text, int columns) {
  int used = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    used += width(text[i]);
    if (used > columns) return i;
  }
  return text.size();
}

void wrap_line(std::u32string line, int columns, std::vector<std::string>& lines) {
  while (width(line) > columns) {
    const std::size_t most = std::max<std::size_t>(1, fitting(line, columns));
    std::size_t cut = line.rfind(U' ', most);
    if (cut == std::u32string::npos || cut == 0) cut = most;
    lines.push_back(to_utf8(line.substr(0, cut)));
    line.erase(0, line[cut] == U' ' ? cut + 1 : cut);
  }
  lines.push_back(to_utf8(line));
}

}  // namespace

int columns_of(const std::string& text) {
  if (plain_ascii(text)) return static_cast<int>(text.size());
  return width(code_points(text));
}

std::string clipped(const std::string& text, int columns, bool unicode) {
  if (columns_of(text) <= columns) return text;
  const std::u32string ellipsis = unicode ? U"…" : U"...";
  const std::u32string whole = code_points(text);
  const int room = columns - static_cast<int>(ellipsis.size());
  if (room < 1) return to_utf8(whole.substr(0, fitting(whole, std::max(0, columns))));
  return to_utf8(whole.substr(0, fitting(whole, room)) + ellipsis);
}

std::vector<std::string> wrapped(const std::string& text, int columns) {
  std::vector<std::string> lines;
  const std::u32string whole = code_points(text);
  std::size_t from = 0;
  for (;;) {
    const std::size_t to = std::min(whole.find(U'\n', from), whole.size());
    wrap_line(whole.substr(from, to - from), std::max(columns, 1), lines);
    if (to == whole.size()) break;
    from = to + 1;
  }
  while (lines.size() > 1 && lines.back().empty()) lines.pop_back();
  return lines;
}

std::string showable(const std::string& text, bool unicode) {
  if (plain_ascii(text)) return text;
  std::u32string shown = code_points(text);
  for (char32_t& c : shown)
    if (within(kUnsafe, c) || (!unicode && c >= 0x80)) c = U'?';
  return to_utf8(shown);
}

}  // namespace jnd
