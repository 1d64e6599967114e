// Fields that commands of `jnd calc` share: intervals, which JSON has as lists of two, and whom a row is about.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/numerics/special_values.h"
#include "data/blocks/common_fields.h"

namespace jnd {

// Adds KEY, [low, high] in JSON, and KEY.low and KEY.high for tables. ends: gives the two numbers of a row, or nothing.
template <typename Row, typename Get>
void add_interval(Fields<Row>& fields, const std::string& key, Get ends) {
  const auto end = [ends](std::size_t place) {
    return [ends, place](const Row& r) {
      const std::optional<std::vector<double>> both = ends(r);
      return both ? (*both)[place] : kNaN;
    };
  };
  fields.emplace_back(key, "confidence interval", ends);
  fields.emplace_back(key + ".low", "its lower end", end(0), FieldTraits{.place = Place::table});
  fields.emplace_back(key + ".high", "its upper end", end(1), FieldTraits{.place = Place::table});
}
inline TableColumn interval_column(const std::string& key, const std::string& title = "95 % CI") {
  return range(key + ".low", key + ".high", title);
}

// `row.of` names a group of counts, or a participant and condition of trials; "name" is the group in tables. first: of
// the first row.
template <typename Row, typename Unit>
Fields<Row> unit_fields(const Unit& first) {
  Fields<Row> fields = {common<Row>("group", [](const Row& r) { return r.of.name; }),
                        Field<Row>("name", "the group, or all", [](const Row& r) { return r.of.name.value_or("all"); },
                                   {.title = "group", .place = Place::table})};
  if (first.participant) fields.push_back(common<Row>("participant", [](const Row& r) { return r.of.participant; }));
  if (first.condition) fields.push_back(common<Row>("condition", [](const Row& r) { return r.of.condition; }));
  return fields;
}

}  // namespace jnd
