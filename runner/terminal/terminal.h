// What depends on the terminal: whether there is one, its width, and colours that NO_COLOR switches off.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace jnd {

bool is_terminal(int file_descriptor) noexcept;
int terminal_width() noexcept;  // columns of standard output; 80 where unknown
int terminal_rows() noexcept;   // its lines; 24 where unknown
// Columns that a table may take: those of standard output, 0 (without end) where that is no terminal.
std::size_t table_width() noexcept;

// Text for standard output; plain where that is not a terminal or NO_COLOR is set. Never the only carrier of meaning.
std::string bold(std::string_view text);
std::string dim(std::string_view text);
std::string warn(std::string_view text);

// Text from files, people or arguments, made safe for a terminal: runner/terminal/printable_text.cpp. What a terminal
// would obey, reorder or hide becomes visible: control characters (C0, DEL, C1), bytes that are not UTF-8 ("\\x1b"),
// controls of direction, zero-width characters, line and paragraph separators ("\\u{202e}"). Text made so is not
// changed again.
std::string printable(std::string_view text);
// The same of a message with lines of its own: line feeds stay.
std::string printable_lines(std::string_view text);
// The same of a JSON document, as JSON escapes: what a reader of it gets is not changed.
std::string printable_json(std::string_view document);

// Columns of a terminal that a UTF-8 text takes: 2 for East Asian wide characters and emoji, 0 for combining marks, 1
// for all else.
std::size_t display_width(std::string_view text) noexcept;

// Broken between words into lines of at most so many columns; a longer word has a line to itself. At least one line.
std::vector<std::string> wrapped_words(const std::string& text, std::size_t columns);

// In single quotes, as a shell of the Bourne family takes it.
std::string shell_quoted(std::string_view text);
// The name of a file in a command that is printed to be copied: one word of a shell, safe for a terminal and no option,
// in quotes where it needs them.
std::string shell_word(std::string_view name);

// Minutes and seconds as a person says them: "35 s", "24 min", "1 h 05 min".
std::string duration_text(double seconds);

}  // namespace jnd
