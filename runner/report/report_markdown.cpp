#include "runner/report/report_markdown.h"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <vector>

#include <fmt/format.h>

#include "runner/figures/svg.h"

namespace jnd {

namespace {

bool is_escape(std::string_view text, std::size_t place) {
  return text[place] == '\\' && place + 1 < text.size() &&
         std::ispunct(static_cast<unsigned char>(text[place + 1])) != 0;
}

// The place of `mark`, where no backslash takes its meaning.
std::size_t find_mark(std::string_view text, std::string_view mark, std::size_t from) {
  for (std::size_t place = from; place < text.size(); ++place) {
    if (is_escape(text, place))
      ++place;
    else if (text.substr(place).starts_with(mark))
      return place;
  }
  return std::string_view::npos;
}

// As HTML, without the backslashes.
std::string literal_html(std::string_view text) {
  std::string plain;
  for (std::size_t place = 0; place < text.size(); ++place) {
    if (is_escape(text, place)) ++place;
    plain += text[place];
  }
  return escape_markup(plain);
}

// Escaped, with `code` and **strong** where both ends stand in the same text.
std::string inline_html(std::string_view text) {
  std::string html;
  while (!text.empty()) {
    const std::size_t code = find_mark(text, "`", 0), strong = find_mark(text, "**", 0);
    const std::size_t begin = std::min(code, strong);
    if (begin == std::string_view::npos) break;
    const bool is_code = code < strong;
    const std::string_view mark = is_code ? "`" : "**";
    const std::size_t inside_at = begin + mark.size();
    // Backslashes mean nothing within code.
    const std::size_t end = is_code ? text.find(mark, inside_at) : find_mark(text, mark, inside_at);
    if (end == std::string_view::npos) break;
    const std::string_view inside = text.substr(inside_at, end - inside_at);
    html += literal_html(text.substr(0, begin));
    html += is_code ? fmt::format("<code>{}</code>", escape_markup(inside))
                    : fmt::format("<strong>{}</strong>", literal_html(inside));
    text.remove_prefix(end + mark.size());
  }
  return html + literal_html(text);
}

std::string_view trimmed(std::string_view line) {
  while (!line.empty() && (line.front() == ' ' || line.front() == '\t')) line.remove_prefix(1);
  while (!line.empty() && (line.back() == ' ' || line.back() == '\t' || line.back() == '\r')) line.remove_suffix(1);
  return line;
}

// How many characters open a list item: 0 where the line is none. ordered: "1. ".
std::size_t item_mark(std::string_view line, bool& ordered) {
  ordered = false;
  if (line.starts_with("- ") || line.starts_with("* ")) return 2;
  const std::size_t digits = line.find_first_not_of("0123456789");
  if (digits == 0 || digits == std::string_view::npos || digits > 3) return 0;
  if (line.substr(digits, 2) != ". ") return 0;
  ordered = true;
  return digits + 2;
}

class Writer {
 public:
  explicit Writer(int top_heading) : top_heading_(top_heading) {}

  void line(std::string_view raw) {
    const std::string_view line = trimmed(raw);
    if (line.empty()) return flush();
    const std::size_t hashes = line.find_first_not_of('#');
    if (hashes != 0 && hashes != std::string_view::npos && line[hashes] == ' ') {
      close();
      const int level = std::min(6, top_heading_ + static_cast<int>(hashes) - 1);
      html_ += fmt::format("<h{0}>{1}</h{0}>\n", level, inline_html(trimmed(line.substr(hashes))));
      return;
    }
    bool ordered = false;
    const std::size_t mark = item_mark(line, ordered);
    if (mark > 0) {
      const std::string_view list = ordered ? "ol" : "ul";
      flush();
      if (list_ != list) {
        close();
        html_ += fmt::format("<{}>\n", list);
        list_ = list;
      }
      item_ = true;
      text_ = line.substr(mark);
      return;
    }
    if (text_.empty()) close();  // a paragraph ends the list before it
    text_ += (text_.empty() ? "" : " ") + std::string(line);
  }

  std::string finish() {
    close();
    return html_;
  }

 private:
  // Writes the paragraph or item that is being read.
  void flush() {
    if (text_.empty()) return;
    html_ += fmt::format("<{0}>{1}</{0}>\n", item_ ? "li" : "p", inline_html(text_));
    text_.clear();
    item_ = false;
  }
  void close() {
    flush();
    if (!list_.empty()) html_ += fmt::format("</{}>\n", list_);
    list_ = {};
  }

  int top_heading_;
  std::string html_, text_;
  std::string_view list_;  // "ul" or "ol" while one is open
  bool item_ = false;
};

}  // namespace

std::string markdown_to_html(std::string_view markdown, int top_heading) {
  Writer writer(top_heading);
  while (!markdown.empty()) {
    const std::size_t end = std::min(markdown.find('\n'), markdown.size());
    writer.line(markdown.substr(0, end));
    markdown.remove_prefix(std::min(end + 1, markdown.size()));
  }
  return writer.finish();
}

}  // namespace jnd
