// Numbers for --json: no bare NaN or infinity ever appears.
#pragma once

#include <cmath>

#include <nlohmann/json.hpp>

#include "protocols/input_error.h"

namespace jnd {

// NaN becomes null, infinities the strings "inf" and "-inf".
inline nlohmann::ordered_json json_number(double value) {
  if (std::isnan(value)) return nullptr;
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  return value;
}

inline nlohmann::ordered_json to_json(const Diagnostic& diagnostic) {
  return {{"file", diagnostic.file}, {"line", diagnostic.line},       {"column", diagnostic.column},
          {"path", diagnostic.path}, {"message", diagnostic.message}, {"suggestion", diagnostic.suggestion}};
}

}  // namespace jnd
