// What people cannot see or tell apart in a text.
//
// Blanks of every kind and characters without a shape: what takes room on a screen, or none at all, and shows nothing.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace jnd {

// How many bytes the blank takes that a text (UTF-8) begins with; 0 where it begins with something else. Blanks: white
// space and line ends, zero-width and invisible characters, marks of direction, byte order marks (Unicode 15:
// White_Space, Default_Ignorable_Code_Point, and U+2800), and control characters.
std::size_t leading_blank(std::string_view text) noexcept;

// Without the blanks at both ends.
std::string_view without_blanks(std::string_view text) noexcept;

// Codes of people that are taken for one another: in other capitals, with other zeros before a number (P1, P001), or
// with a letter and its accent as one character or as two.

// The same for all codes that look alike. Of letters with accents those of Latin-1 and Latin Extended-A are known.
std::string look_of(std::string_view code);

// "\"1\" and \"01\", \"P2\" and \"p2\"": of different codes, each with the first that looks as it does; empty where
// none does. Of codes that print alike it says how many characters they have.
std::string look_alikes(const std::vector<std::string>& codes);

}  // namespace jnd
