#include "protocols/input/blank_text.h"

#include <algorithm>
#include <array>
#include <cstdint>

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

}  // namespace jnd
