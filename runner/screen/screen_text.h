// Text in columns of a terminal: how wide it is, cut to fit, broken into lines. Pure.
#pragma once

#include <string>
#include <vector>

namespace jnd {

// Columns that UTF-8 text takes: 0 for combining marks, 2 for East Asian wide characters and most pictures.
int columns_of(const std::string& text);
// Cut to fit, with an ellipsis (three points where not unicode).
std::string clipped(const std::string& text, int columns, bool unicode);
// Broken at spaces, and in words that are too long; line ends stay. At least one line.
std::vector<std::string> wrapped(const std::string& text, int columns);
// What the terminal can show: without unicode other characters than ASCII become '?'. Characters that would move the
// cursor or turn the direction of writing become '?' always.
std::string showable(const std::string& text, bool unicode);

}  // namespace jnd
