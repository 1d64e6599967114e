// What depends on the terminal: whether there is one, its width, and colours that NO_COLOR switches off.
#pragma once

#include <string>
#include <string_view>

namespace jnd {

bool is_terminal(int file_descriptor) noexcept;
int terminal_width() noexcept;  // columns of standard output; 80 where unknown

// Text for standard output; plain where that is not a terminal or NO_COLOR is set. Never the only carrier of meaning.
std::string bold(std::string_view text);
std::string dim(std::string_view text);
std::string warn(std::string_view text);

// Control characters made visible, so that no text from a file reaches the terminal as a command.
std::string printable(std::string_view text);

// Minutes and seconds as a person says them: "35 s", "24 min", "1 h 05 min".
std::string duration_text(double seconds);

}  // namespace jnd
