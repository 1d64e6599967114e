// UTF-8: checked, counted, cut between characters, and as code points.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace jnd {

// Whether the byte is the second, third or fourth of a character.
constexpr bool is_continuation(char byte) noexcept {
  return (static_cast<unsigned char>(byte) & 0xC0U) == 0x80U;
}

// The offset of the first byte that is not part of well-formed UTF-8 (no overlong forms, no surrogates), or npos.
std::size_t first_invalid_utf8(std::string_view bytes) noexcept;
// Characters (code points) of well-formed UTF-8.
std::size_t count_characters(std::string_view text) noexcept;
// The last place between two characters at or before `at` (bytes; at most the text's length).
std::size_t character_boundary(std::string_view text, std::size_t at) noexcept;

// UTF-8 to code points and back; what is no character becomes U+FFFD.
std::u32string code_points(const std::string& utf8);
std::string to_utf8(const std::u32string& text);
std::string to_utf8(char32_t code_point);

}  // namespace jnd
