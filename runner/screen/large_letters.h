// Large letters, drawn from the cells of a terminal: words that are read from two metres. Pure.
//
// The font is a small one of our own: a glyph is 1 to 5 pixels wide and 9 high, of which 7 stand above the line. It has
// the letters, digits and punctuation of Western European languages.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace jnd {

// How a pixel is drawn.
enum class LetterSize {
  half,  // one column and half a row: a line of letters is 5 rows high
  full   // two columns and one row: 9 rows
};

// Rows of a line of letters.
int large_rows(LetterSize size) noexcept;
// The text in large letters, broken at spaces, in as many lines as it takes: each row is at most `columns` wide. None where a
// character has no glyph, or a word is too wide. unicode: half blocks; otherwise ' _ and # stand for them.
std::optional<std::vector<std::string>> large_text(const std::string& text, int columns, LetterSize size, bool unicode);
// The same in the largest size that fits into so many rows; none where nothing does.
std::optional<std::vector<std::string>> largest_text(const std::string& text, int columns, int rows, bool unicode);

}  // namespace jnd
