// The few words of Markdown that the methods text uses, as HTML: headings, paragraphs, lists, `code` and **strong**.
#pragma once

#include <string>
#include <string_view>

namespace jnd {

// A backslash before punctuation makes it text. Everything else is text and escaped; raw HTML, links and images are not
// understood. "# " becomes <hN> with N = top_heading (1..6), "## " the next, down to <h6>. Lines of a paragraph or list
// item are joined.
std::string markdown_to_html(std::string_view markdown, int top_heading);

}  // namespace jnd
