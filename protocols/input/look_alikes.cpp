#include "protocols/input/look_alikes.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>

#include <fmt/format.h>

#include "protocols/input/json_reader.h"
#include "protocols/input/utf8.h"

namespace jnd {

namespace {

struct Range {
  char32_t first, last;
};

constexpr std::array<Range, 22> kBlanks = {
    {{0x00, 0x20},     {0x7F, 0xA0},       {0xAD, 0xAD},       {0x34F, 0x34F},    {0x61C, 0x61C},   {0x115F, 0x1160},
     {0x1680, 0x1680}, {0x17B4, 0x17B5},   {0x180B, 0x180F},   {0x2000, 0x200F},  {0x2028, 0x202F}, {0x205F, 0x206F},
     {0x2800, 0x2800}, {0x3000, 0x3000},   {0x3164, 0x3164},   {0xFE00, 0xFE0F},  {0xFEFF, 0xFEFF}, {0xFFA0, 0xFFA0},
     {0xFFF0, 0xFFF8}, {0x1BCA0, 0x1BCA3}, {0x1D173, 0x1D17A}, {0xE0000, 0xE0FFF}}};

bool blank(char32_t point) noexcept {
  return std::any_of(kBlanks.begin(), kBlanks.end(),
                     [point](const Range& range) { return point >= range.first && point <= range.last; });
}

// How many bytes the character takes that begins with this one; 1 for what begins none.
std::size_t length_of(char first) noexcept {
  const auto byte = static_cast<unsigned char>(first);
  return byte < 0xC2 || byte > 0xF4 ? 1 : byte >= 0xF0 ? 4 : byte >= 0xE0 ? 3 : 2;
}

// Of the letters from U+00C0 on without their accents, and small; '.' of what has none.
constexpr std::string_view kPlainLetters =
    "aaaaaa.ceeeeiiii.nooooo..uuuuy.."
    "aaaaaa.ceeeeiiii.nooooo..uuuuy.y"
    "aaaaaaccccccccdd..eeeeeeeeeegggg"
    "gggghh..iiiiiiiii...jjkk.llllll."
    "...nnnnnn...oooooo..rrrrrrssssss"
    "sstttt..uuuuuuuuuuuuwwyyyzzzzzz.";
constexpr char32_t kFirstLetter = 0xC0, kFirstAccent = 0x300, kLastAccent = 0x36F;

char32_t plain(char32_t letter) {
  if (letter >= U'A' && letter <= U'Z') return letter - U'A' + U'a';
  if (letter < kFirstLetter || letter >= kFirstLetter + kPlainLetters.size()) return letter;
  const char known = kPlainLetters[letter - kFirstLetter];
  return known == '.' ? letter : static_cast<char32_t>(known);
}

bool is_digit(char32_t character) {
  return character >= U'0' && character <= U'9';
}

}  // namespace

std::size_t leading_blank(std::string_view text) noexcept {
  if (text.empty()) return 0;
  const std::size_t length = length_of(text.front());
  const auto first = static_cast<unsigned char>(text.front());
  if (length == 1) return first < 0x80 && blank(first) ? 1 : 0;
  if (text.size() < length) return 0;
  char32_t point = first & (0x7FU >> length);
  for (const char byte : text.substr(1, length - 1)) {
    if (!is_continuation(byte)) return 0;
    point = (point << 6U) | (static_cast<unsigned char>(byte) & 0x3FU);
  }
  return blank(point) ? length : 0;
}

std::string_view without_blanks(std::string_view text) noexcept {
  while (const std::size_t blank = leading_blank(text)) text.remove_prefix(blank);
  while (!text.empty()) {
    std::size_t begin = text.size() - 1;
    while (begin > 0 && text.size() - begin < 4 && is_continuation(text[begin])) --begin;
    if (leading_blank(text.substr(begin)) != text.size() - begin) break;
    text.remove_suffix(text.size() - begin);
  }
  return text;
}

std::string look_of(std::string_view code) {
  std::u32string look;
  for (const char32_t character : code_points(std::string(code))) {
    if (character >= kFirstAccent && character <= kLastAccent) continue;
    // A zero that a number begins with gives way to the next digit.
    const bool zero = !look.empty() && look.back() == U'0' && (look.size() == 1 || !is_digit(look[look.size() - 2]));
    if (zero && is_digit(character)) look.pop_back();
    look += plain(character);
  }
  return to_utf8(look);
}

std::string look_alikes(const std::vector<std::string>& codes) {
  std::map<std::string, std::string> first;  // by look
  std::string text;
  for (const std::string& code : codes) {
    const std::string& other = first.try_emplace(look_of(code), code).first->second;
    if (other == code) continue;
    text += fmt::format("{}{} and {}", text.empty() ? "" : ", ", in_quotes(other), in_quotes(code));
    const std::size_t one = count_characters(other), two = count_characters(code);
    if (other.size() > one || code.size() > two) text += fmt::format(" ({} and {} characters)", one, two);
  }
  return text;
}

}  // namespace jnd
