// The few words of Markdown that the methods text uses, as HTML: headings, paragraphs, lists, `code`, **strong** and
// *emphasis*.
#pragma once

#include <string>
#include <string_view>

namespace jnd {

// Read as CommonMark. Raw HTML and whatever else has a meaning there, links and images among it, is written as its text
// alone, escaped: no address and no attribute comes through. "# " becomes <hN> with N = top_heading (1..6), "## " the
// next, down to <h6>. Lines of a paragraph or list item are joined.
std::string markdown_to_html(std::string_view markdown, int top_heading);

}  // namespace jnd
