// What takes room on a screen, or none at all, and shows nothing: blanks of every kind and characters without a shape.
#pragma once

#include <cstddef>
#include <string_view>

namespace jnd {

// How many bytes the blank takes that a text (UTF-8) begins with; 0 where it begins with something else. Blanks: white
// space and line ends, zero-width and invisible characters, marks of direction, byte order marks (Unicode 15:
// White_Space, Default_Ignorable_Code_Point, and U+2800), and control characters.
std::size_t leading_blank(std::string_view text) noexcept;

// Without the blanks at both ends.
std::string_view without_blanks(std::string_view text) noexcept;

}  // namespace jnd
