#include "protocols/input/json_text.h"

#include <nlohmann/json.hpp>

namespace jnd {

using nlohmann::ordered_json;

namespace {

// The library copies, compares and writes values by recursion: a deeper text would use up the stack.
bool is_too_deep(std::string_view text) noexcept {
  std::size_t depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"') in_string = !in_string;
    if (in_string) {
      if (c == '\\') ++i;  // whatever is escaped is neither quote nor bracket
    } else if (c == '[' || c == '{') {
      if (++depth > kMostJsonDepth) return true;
    } else if ((c == ']' || c == '}') && depth > 0) {
      --depth;
    }
  }
  return false;
}

}  // namespace

ordered_json json_from(std::string_view text) {
  if (is_too_deep(text)) throw ordered_json::parse_error::create(101, 0, "nested too deep", nullptr);
  return ordered_json::parse(text);
}

ordered_json json_if_valid(std::string_view text) {
  return is_too_deep(text) ? ordered_json(ordered_json::value_t::discarded) : ordered_json::parse(text, nullptr, false);
}

std::string json_text(const nlohmann::ordered_json& value, int indent) {
  return value.dump(indent, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace jnd
