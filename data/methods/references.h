// The works that the methods text cites, in full.
#pragma once

#include <string>
#include <string_view>

namespace jnd {

// A Markdown list with the heading "References": each work that the text cites as its index names it ("Hautus 1995"),
// in alphabetical order, and no other. Empty where the text cites none. Begins and ends with a newline.
std::string references_of(std::string_view text);

}  // namespace jnd
