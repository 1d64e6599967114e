// The works that the methods text cites, in full.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace jnd {

struct Reference {
  std::string_view cited;  // in the text: "Hautus 1995"
  std::string_view full;   // authors, year, title and where it appeared
};

// Every work that some methods text cites, in alphabetical order.
std::span<const Reference> all_references() noexcept;

// A Markdown list with the heading "References": each work that the text cites as its index names it ("Hautus 1995"),
// in alphabetical order, and no other. Empty where the text cites none. Begins and ends with a newline.
std::string references_of(std::string_view text);

}  // namespace jnd
