// Names of files in commands that are printed to be copied.
#pragma once

#include <string>
#include <string_view>

namespace jnd {

// The name as one word of a shell, safe for a terminal: in quotes where it needs them, and never an option.
std::string shell_word(std::string_view name);

}  // namespace jnd
