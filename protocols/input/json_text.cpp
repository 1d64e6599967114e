#include "protocols/input/json_text.h"

#include <nlohmann/json.hpp>

namespace jnd {

nlohmann::ordered_json json_from(std::string_view text) {
  return nlohmann::ordered_json::parse(text);
}

nlohmann::ordered_json json_if_valid(std::string_view text) {
  return nlohmann::ordered_json::parse(text, nullptr, false);
}

std::string json_text(const nlohmann::ordered_json& value, int indent) {
  return value.dump(indent, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace jnd
