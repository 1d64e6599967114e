// JSON with places: a document tree in which every value knows its line, column and path, and no duplicate key is lost.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "protocols/input/input_error.h"

namespace jnd {

struct JsonNode {
  enum class Kind { null, boolean, number, string, array, object } kind = Kind::null;
  bool boolean = false;
  double number = 0;
  bool integer = false;                         // the number is whole: 16, 16.0 and 1e3 are
  std::string text;                             // string value; for numbers the literal
  std::vector<JsonNode> items;                  // array elements, or the values of an object
  std::vector<std::string> keys;                // of an object, parallel to items, in the file's order, duplicates kept
  int line = 0, column = 0;                     // of the value's first character
  std::vector<std::pair<int, int>> key_places;  // of the keys, parallel to keys
  std::string path;                             // "$", "$.trial.gap_s", "$.series[1]"

  const JsonNode* find(std::string_view key) const noexcept;  // first member of that name, or null
};

// Throws InputError with the line and column of a syntax error. Limits: 1 MiB, depth 64, 20000 values, 2000 members of
// an object, keys of 256 bytes. A UTF-8 BOM is an error.
JsonNode parse_json(std::string_view bytes, const std::string& file);

// Makes every number a decimal of 15 digits (decimal_order.h): of what a user writes, not of what a device is limited to.
void round_numbers(JsonNode& node);

}  // namespace jnd
