#include "runner/report/report_markdown.h"

#include <algorithm>
#include <new>
#include <vector>

#include <fmt/format.h>
#include <md4c.h>

#include "analysis/numerics/words.h"
#include "runner/drawing/svg.h"

namespace jnd {

namespace {

// What is not named here, such as links, images and quotations, becomes no element: only its text is written.
constexpr auto kBlocks =
    words<MD_BLOCKTYPE>({{"p", MD_BLOCK_P}, {"ul", MD_BLOCK_UL}, {"ol", MD_BLOCK_OL}, {"li", MD_BLOCK_LI}});
constexpr auto kSpans = words<MD_SPANTYPE>({{"code", MD_SPAN_CODE}, {"strong", MD_SPAN_STRONG}, {"em", MD_SPAN_EM}});

struct MarkdownOutput {
  int top_heading;
  std::string html;
  std::vector<std::string_view> spans{};  // that are open, by their elements
};

template <bool ends>
int write_block(MD_BLOCKTYPE type, void* detail, void* user) {
  auto& out = *static_cast<MarkdownOutput*>(user);
  for (; ends && !out.spans.empty(); out.spans.pop_back()) out.html += fmt::format("</{}>", out.spans.back());
  std::string element(word_of(kBlocks, type));
  if (type == MD_BLOCK_H)
    element = fmt::format(
        "h{}", std::min(6, out.top_heading - 1 + static_cast<int>(static_cast<MD_BLOCK_H_DETAIL*>(detail)->level)));
  const bool breaks = ends || type == MD_BLOCK_UL || type == MD_BLOCK_OL;
  if (!element.empty()) out.html += fmt::format("<{}{}>{}", ends ? "/" : "", element, breaks ? "\n" : "");
  return 0;
}

template <bool ends>
int write_span(MD_SPANTYPE type, void* /*detail*/, void* user) {
  auto& out = *static_cast<MarkdownOutput*>(user);
  const std::string_view element = word_of(kSpans, type);
  if (element.empty()) return 0;
  // md4c may end an emphasis whose beginning it has taken for a link's address: "![a](*)*".
  if (ends && (out.spans.empty() || out.spans.back() != element)) return 0;
  if (ends)
    out.spans.pop_back();
  else
    out.spans.push_back(element);
  out.html += fmt::format("<{}{}>", ends ? "/" : "", element);
  return 0;
}

int write_text(MD_TEXTTYPE type, const char* text, MD_SIZE size, void* user) {
  const bool line_ends = type == MD_TEXT_SOFTBR || type == MD_TEXT_BR;
  static_cast<MarkdownOutput*>(user)->html += line_ends ? " " : escape_markup({text, size});
  return 0;
}

}  // namespace

std::string markdown_to_html(std::string_view markdown, int top_heading) {
  constexpr unsigned kFlags = MD_FLAG_NOHTML | MD_FLAG_NOINDENTEDCODEBLOCKS;
  const MD_PARSER parser{
      0,       kFlags, write_block<false>, write_block<true>, write_span<false>, write_span<true>, write_text,
      nullptr, nullptr};
  MarkdownOutput out{top_heading, {}, {}};
  if (md_parse(markdown.data(), static_cast<MD_SIZE>(markdown.size()), &parser, &out) != 0) throw std::bad_alloc();
  return out.html;
}

}  // namespace jnd
