// JSON documents from and to text. The library's parser and writer are compiled here alone: they take seconds in each wing.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

namespace jnd {

inline constexpr std::size_t kMostJsonDepth = 64;  // levels of objects and arrays

// Throws nlohmann::json::parse_error where the text is no JSON, or nested deeper than kMostJsonDepth.
nlohmann::ordered_json json_from(std::string_view text);
// is_discarded() in these cases.
nlohmann::ordered_json json_if_valid(std::string_view text);
// On one line; with blanks to indent by, on several. Text that is not UTF-8 keeps its readable part.
std::string json_text(const nlohmann::ordered_json& value, int indent = -1);

}  // namespace jnd
