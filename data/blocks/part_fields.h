// Fields of the parts of a row, such as the fit of one model, many at once.
#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "data/fields/block.h"

namespace jnd {

// Adds PREFIX + key for each key and member behind it. means, traits: of all of them. part: gives the part of a row.
template <typename Row, typename Get, typename Member, typename... Others>
void add_parts(Fields<Row>& fields, const std::string& prefix, std::string_view means, const FieldTraits& traits,
               Get part, std::string_view key, Member member, Others... others) {
  fields.emplace_back(
      prefix + std::string(key), means, [part, member](const Row& row) { return read(member, read(part, row)); },
      traits);
  if constexpr (sizeof...(others) > 0) add_parts(fields, prefix, means, traits, part, others...);
}

// The [low, high] of a part, for add_interval().
template <typename Get, typename Part>
auto ends(Get part, double Part::*low, double Part::*high) {
  return [part, low, high](const auto& row) {
    const Part& of = read(part, row);
    return std::vector<double>{of.*low, of.*high};
  };
}

// KEY: the name of a row, null without one; in tables "name" is "all" then.
template <typename Row, typename Get>
Fields<Row> name_fields(std::string_view key, Get name) {
  return {Field<Row>(key, "name of the row", name),
          Field<Row>("name", "the same for tables", [name](const Row& r) { return read(name, r).value_or("all"); },
                     {.title = key, .place = Place::table})};
}

// The columns of a table. const char*: the key of a field.
template <typename... Columns>
std::vector<TableColumn> columns(Columns... all) {
  return {TableColumn{all}...};
}
inline TableColumn titled(std::string key, std::string title) {
  return {std::move(key), {}, {}, std::move(title)};
}
// "1.23 ± 0.12" of KEY and KEY_se; the estimate alone if the standard error is null.
inline TableColumn with_se(const std::string& key, std::string title) {
  return share(key, key + "_se", std::move(title), " ± ");
}
inline std::optional<double> null_if_nan(double value) {
  return std::isnan(value) ? std::nullopt : std::optional(value);
}

}  // namespace jnd
