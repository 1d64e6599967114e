// JSON as a person writes it: what fits on a line stands on one.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace jnd {

// Objects and lists that fit on one line with what stands before them do; the document itself is spread. Ends with a
// line feed.
std::string readable_json(const nlohmann::ordered_json& document);

}  // namespace jnd
