#include "protocols/input/utf8.h"

#include <algorithm>
#include <cstdint>

namespace jnd {

namespace {

constexpr char32_t kReplacement = 0xfffd;

void append_utf8(std::string& to, char32_t c) {
  if (c > 0x10ffff || (c >= 0xd800 && c <= 0xdfff)) c = kReplacement;
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

std::size_t first_invalid_utf8(std::string_view bytes) noexcept {
  std::size_t at = 0;
  while (at < bytes.size()) {
    const auto lead = static_cast<unsigned char>(bytes[at]);
    std::size_t length = 0;
    std::uint32_t value = 0;
    if (lead < 0x80) {
      ++at;
      continue;
    }
    if (lead >= 0xC2 && lead <= 0xDF) {
      length = 2;
      value = lead & 0x1FU;
    } else if (lead >= 0xE0 && lead <= 0xEF) {
      length = 3;
      value = lead & 0x0FU;
    } else if (lead >= 0xF0 && lead <= 0xF4) {
      length = 4;
      value = lead & 0x07U;
    } else {
      return at;
    }
    if (at + length > bytes.size()) return at;
    for (std::size_t i = 1; i < length; ++i) {
      if (!is_continuation(bytes[at + i])) return at;
      value = (value << 6U) | (static_cast<unsigned char>(bytes[at + i]) & 0x3FU);
    }
    const bool overlong = (length == 3 && value < 0x800) || (length == 4 && value < 0x10000);
    if (overlong || (value >= 0xD800 && value <= 0xDFFF) || value > 0x10FFFF) return at;
    at += length;
  }
  return std::string_view::npos;
}

std::size_t character_boundary(std::string_view text, std::size_t at) noexcept {
  at = std::min(at, text.size());
  while (at > 0 && at < text.size() && is_continuation(text[at])) --at;
  return at;
}

std::size_t count_characters(std::string_view text) noexcept {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) { return !is_continuation(c); }));
}

std::string to_utf8(char32_t code_point) {
  std::string utf8;
  append_utf8(utf8, code_point);
  return utf8;
}

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

}  // namespace jnd
