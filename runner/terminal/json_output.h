// Numbers for --json: no bare NaN or infinity ever appears.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "protocols/input/input_error.h"
#include "protocols/input/json_text.h"
#include "runner/terminal/terminal.h"

namespace jnd {

// NaN becomes null, infinities the strings "inf" and "-inf".
inline nlohmann::ordered_json json_number(double value) {
  if (std::isnan(value)) return nullptr;
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  return value;
}

inline nlohmann::ordered_json json_numbers(const std::vector<double>& values) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const double value : values) list.push_back(json_number(value));
  return list;
}

// One line for standard output, which may be a terminal; text that is not UTF-8 keeps its readable part.
inline std::string json_line(const nlohmann::ordered_json& value) {
  return printable_json(json_text(value));
}

// Prints one JSON document on a line.
inline void print_json(const nlohmann::ordered_json& document) {
  fmt::print("{}\n", json_line(document));
}

inline nlohmann::ordered_json to_json(const Diagnostic& diagnostic) {
  return {{"file", diagnostic.file}, {"line", diagnostic.line},       {"column", diagnostic.column},
          {"path", diagnostic.path}, {"message", diagnostic.message}, {"suggestion", diagnostic.suggestion}};
}

}  // namespace jnd
