// Is a page or picture well formed? A small checker, so that a test needs no parser of its own.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace jnd {

// Every tag is closed in order, every attribute stands in double quotes, no bare & or <. Empty where all is well, else
// what is wrong.
inline std::string markup_problem(std::string_view text) {
  std::vector<std::string> open;
  std::size_t at = 0;
  const auto around = [&](std::size_t place) { return std::string(text.substr(place, 60)); };
  while (at < text.size()) {
    const std::size_t begin = text.find_first_of("<&>", at);
    if (begin == std::string_view::npos) break;
    if (text[begin] == '>') return "bare >: " + around(begin);
    if (text[begin] == '&') {
      const std::size_t end = text.find(';', begin);
      if (end == std::string_view::npos || end - begin > 7) return "bare &: " + around(begin);
      at = end + 1;
      continue;
    }
    std::size_t end = begin + 1;
    for (bool quoted = false; end < text.size() && (quoted || text[end] != '>'); ++end) {
      if (text[end] == '"') quoted = !quoted;
      if (text[end] == '<') return "bare <: " + around(begin);
    }
    if (end >= text.size()) return "unfinished tag: " + around(begin);
    const std::string_view tag = text.substr(begin + 1, end - begin - 1);
    at = end + 1;
    if (tag.starts_with('!') || tag.starts_with('?')) continue;
    const bool closing = tag.starts_with('/');
    const std::string name(tag.substr(closing ? 1 : 0, tag.find_first_of(" /", 1) - (closing ? 1 : 0)));
    if (closing) {
      if (open.empty() || open.back() != name) return "closed out of order: " + around(begin);
      open.pop_back();
    } else if (!tag.ends_with('/') && name != "meta") {
      open.push_back(name);
      if (name == "style") at = text.find("</style>", at);
    }
  }
  return open.empty() ? "" : "never closed: " + open.back();
}

inline std::size_t count_of(std::string_view text, std::string_view what) {
  std::size_t count = 0;
  for (std::size_t at = text.find(what); at != std::string_view::npos; at = text.find(what, at + what.size())) ++count;
  return count;
}

}  // namespace jnd
