// Whole numbers from the bodies of events, which a damaged or forged study can fill with anything.
#pragma once

#include <cstdint>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace jnd {

/// A whole number. json.hpp's own get<int>() would cut 1.5 to 1, wrap 2^32 to 0 and is undefined for 1e99.
/// @throws nlohmann::json::exception if it is none, or does not fit into Whole (int, std::int64_t).
template <typename Whole = int>
Whole whole(const nlohmann::ordered_json& value) {
  using Json = nlohmann::ordered_json;
  const auto number = value.get_ref<const Json::number_integer_t&>();  // a type_error for anything else
  const bool too_large = value.is_number_unsigned() && number < 0;     // 2^63 and more
  if (too_large || !std::in_range<Whole>(number))
    throw nlohmann::json::out_of_range::create(401, fmt::format("the number {} is out of range", value.dump()),
                                               nullptr);
  return static_cast<Whole>(number);
}

/// The whole number under `key`. @throws nlohmann::json::exception as whole(), and if there is none.
template <typename Whole = int>
Whole whole_at(const nlohmann::ordered_json& body, std::string_view key) {
  return whole<Whole>(body.at(key));
}

/// The same, or `fallback` if the body has no such key. @throws nlohmann::json::exception as whole().
inline int whole_or(const nlohmann::ordered_json& body, std::string_view key, int fallback) {
  const auto found = body.find(key);
  return found == body.end() ? fallback : whole(*found);
}

}  // namespace jnd
