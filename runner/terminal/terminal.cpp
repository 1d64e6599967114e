#include "runner/terminal/terminal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <iterator>
#include <sstream>

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace jnd {

namespace {
std::string styled(const char* code, std::string_view text) {
  static const bool colours = is_terminal(STDOUT_FILENO) && std::getenv("NO_COLOR") == nullptr;
  return colours ? fmt::format("\033[{}m{}\033[0m", code, text) : std::string(text);
}
}  // namespace

bool is_terminal(int file_descriptor) noexcept {
  return isatty(file_descriptor) == 1;
}

int terminal_width() noexcept {
  winsize size{};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
  return 80;
}

int terminal_rows() noexcept {
  winsize size{};
  constexpr int kUsual = 24;
  return ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_row > 0 ? size.ws_row : kUsual;
}

std::size_t table_width() noexcept {
  constexpr int kLeast = 20;
  return is_terminal(STDOUT_FILENO) ? static_cast<std::size_t>(std::max(terminal_width(), kLeast)) : 0;
}

std::string bold(std::string_view text) {
  return styled("1", text);
}
std::string dim(std::string_view text) {
  return styled("2", text);
}
std::string warn(std::string_view text) {
  return styled("33", text);
}

std::string shell_quoted(std::string_view text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::string shell_word(std::string_view name) {
  constexpr std::string_view kPlain = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-./,:@%+";
  std::string word = (name.starts_with('-') ? "./" : "") + std::string(name);
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
  if (printable(word) == word) return shell_quoted(word);
  std::string escaped = "$'";  // of bash and zsh
  for (const char c : word)
    escaped += kPlain.find(c) != std::string_view::npos ? std::string(1, c)
                                                        : fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
  return escaped + "'";
}

std::string duration_text(double seconds) {
  const long whole = std::lround(std::max(0.0, seconds));
  if (whole < 90) return fmt::format("{} s", whole);
  const long minutes = (whole + 30) / 60;
  if (minutes < 90) return fmt::format("{} min", minutes);
  return fmt::format("{} h {:02} min", minutes / 60, minutes % 60);
}

// Text that is safe on a terminal, and how wide it is there.

namespace {

struct Range {
  char32_t first, last;
};

// Controls of direction, invisible characters and separators of lines (Unicode: Cf, Zl, Zp, fillers); in order.
constexpr std::array kHidden = {Range{0x00AD, 0x00AD},  Range{0x061C, 0x061C}, Range{0x115F, 0x1160},
                                Range{0x180E, 0x180E},  Range{0x200B, 0x200F}, Range{0x2028, 0x202E},
                                Range{0x2060, 0x206F},  Range{0x3164, 0x3164}, Range{0xFEFF, 0xFEFF},
                                Range{0xFFA0, 0xFFA0},  Range{0xFFF0, 0xFFFB}, Range{0x1D173, 0x1D17A},
                                Range{0xE0000, 0xE0FFF}};

// Two columns (East Asian Width W and F, and emoji); in order.
constexpr std::array kWide = {
    Range{0x1100, 0x115F},   Range{0x231A, 0x231B},   Range{0x23E9, 0x23EC},   Range{0x2E80, 0x303E},
    Range{0x3041, 0x33FF},   Range{0x3400, 0x4DBF},   Range{0x4E00, 0xA4CF},   Range{0xA960, 0xA97C},
    Range{0xAC00, 0xD7A3},   Range{0xF900, 0xFAFF},   Range{0xFE10, 0xFE19},   Range{0xFE30, 0xFE6B},
    Range{0xFF01, 0xFF60},   Range{0xFFE0, 0xFFE6},   Range{0x16FE0, 0x18CFF}, Range{0x1AFF0, 0x1B2FB},
    Range{0x1F300, 0x1F64F}, Range{0x1F680, 0x1F6FF}, Range{0x1F900, 0x1FAFF}, Range{0x20000, 0x3FFFD}};

// No column: marks that stand on the character before them; in order.
constexpr std::array kCombining = {
    Range{0x0300, 0x036F}, Range{0x0483, 0x0489}, Range{0x0591, 0x05BD}, Range{0x05BF, 0x05BF}, Range{0x05C1, 0x05C2},
    Range{0x05C4, 0x05C5}, Range{0x05C7, 0x05C7}, Range{0x0610, 0x061A}, Range{0x064B, 0x065F}, Range{0x0670, 0x0670},
    Range{0x06D6, 0x06DC}, Range{0x06DF, 0x06E4}, Range{0x06E7, 0x06E8}, Range{0x06EA, 0x06ED}, Range{0x0900, 0x0902},
    Range{0x093C, 0x093C}, Range{0x0941, 0x0948}, Range{0x094D, 0x094D}, Range{0x0E31, 0x0E31}, Range{0x0E34, 0x0E3A},
    Range{0x0E47, 0x0E4E}, Range{0x1AB0, 0x1ACE}, Range{0x1DC0, 0x1DFF}, Range{0x20D0, 0x20F0}, Range{0x302A, 0x302D},
    Range{0x3099, 0x309A}, Range{0xFE00, 0xFE0F}, Range{0xFE20, 0xFE2F}};

template <std::size_t N>
bool within(const std::array<Range, N>& ranges, char32_t point) noexcept {
  const auto after = std::upper_bound(ranges.begin(), ranges.end(), point,
                                      [](char32_t wanted, const Range& range) { return wanted < range.first; });
  return after != ranges.begin() && point <= std::prev(after)->last;
}

struct Decoded {
  char32_t point = 0;
  std::size_t bytes = 1;
  bool valid = false;  // otherwise one byte that is not UTF-8
};

// The character at the beginning of a text that is not empty. Overlong forms, surrogates and what is beyond U+10FFFF
// are not UTF-8 (RFC 3629).
Decoded decode(std::string_view text) noexcept {
  const auto byte = [&](std::size_t at) { return static_cast<unsigned char>(text[at]); };
  const unsigned char first = byte(0);
  if (first < 0x80) return {first, 1, true};
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  constexpr std::array<char32_t, 5> kLeast = {0, 0, 0x80, 0x800, 0x10000};
  if (first < 0xC2 || first > 0xF4 || text.size() < length) return {};
  char32_t point = first & (0x7FU >> length);
  for (std::size_t at = 1; at < length; ++at) {
    if ((byte(at) & 0xC0U) != 0x80U) return {};
    point = (point << 6U) | (byte(at) & 0x3FU);
  }
  if (point < kLeast[length] || point > 0x10FFFF || (point >= 0xD800 && point <= 0xDFFF)) return {};
  return {point, length, true};
}

bool obeyed_or_hidden(char32_t point) noexcept {
  return point < 0x20 || (point >= 0x7F && point < 0xA0) || within(kHidden, point);
}

std::string made_safe(std::string_view text, bool keep_line_feeds) {
  std::string safe;
  safe.reserve(text.size());
  while (!text.empty()) {
    const Decoded character = decode(text);
    const std::string_view bytes = text.substr(0, character.bytes);
    if (!character.valid || (character.point < 0x80 && obeyed_or_hidden(character.point))) {
      if (keep_line_feeds && bytes == "\n")
        safe += '\n';
      else
        safe += fmt::format("\\x{:02x}", static_cast<unsigned char>(bytes.front()));
    } else if (obeyed_or_hidden(character.point)) {
      safe += fmt::format("\\u{{{:x}}}", static_cast<std::uint32_t>(character.point));
    } else {
      safe += bytes;
    }
    text.remove_prefix(character.bytes);
  }
  return safe;
}

}  // namespace

std::string printable(std::string_view text) {
  return made_safe(text, false);
}

std::string printable_lines(std::string_view text) {
  return made_safe(text, true);
}

std::string printable_json(std::string_view document) {
  std::string safe;
  safe.reserve(document.size());
  while (!document.empty()) {
    const Decoded character = decode(document);
    const auto point = static_cast<std::uint32_t>(character.point);
    if (!character.valid)
      safe += "\\ufffd";
    else if (!obeyed_or_hidden(character.point) || point == '\n')
      safe += document.substr(0, character.bytes);
    else if (point < 0x10000)
      safe += fmt::format("\\u{:04x}", point);
    else
      safe += fmt::format("\\u{:04x}\\u{:04x}", 0xD7C0U + (point >> 10U), 0xDC00U + (point & 0x3FFU));
    document.remove_prefix(character.bytes);
  }
  return safe;
}

std::size_t display_width(std::string_view text) noexcept {
  std::size_t columns = 0;
  while (!text.empty()) {
    const Decoded character = decode(text);
    columns += within(kWide, character.point) ? 2 : within(kCombining, character.point) ? 0 : 1;
    text.remove_prefix(character.bytes);
  }
  return columns;
}

std::vector<std::string> wrapped_words(const std::string& text, std::size_t columns) {
  std::vector<std::string> lines(1);
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    std::string& line = lines.back();
    if (line.empty())
      line = word;
    else if (display_width(line) + 1 + display_width(word) <= columns)
      line.append(" ").append(word);
    else
      lines.push_back(word);
  }
  return lines;
}

}  // namespace jnd
