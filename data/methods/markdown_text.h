// Text that people wrote, inside Markdown that the program writes.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace jnd {

// The text as CommonMark shows it literally: characters that would be emphasis, code, a link, a tag or an entity have
// a backslash in front; a line break is a blank, so that it can begin no heading or list. For use within a line, after
// other text.
std::string markdown_text(std::string_view text);

// "exponent" -> "Exponent"; "d'" stays.
std::string capitalised(std::string text);
// "a, b and c".
std::string list_of(const std::vector<std::string>& items);
// The ending of a word that counts n things: "" or "s".
const char* plural(std::size_t n) noexcept;

}  // namespace jnd
