// Fields of tests: p values, statistics with a p and a status.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>

#include "analysis/numerics/statistic_status.h"
#include "data/fields/field.h"

namespace jnd {

// An exact test, or one by the normal distribution; nothing without a test.
inline std::optional<std::string> method_of(StatisticStatus status, bool exact) {
  if (status != StatisticStatus::ok) return std::nullopt;
  return exact ? "exact" : "normal";
}

inline std::string status_text(StatisticStatus status) {
  return std::string(to_text(status));
}

// KEY.w, KEY.p, KEY.status. test: of a row a ShapiroWilk or a Mauchly.
template <typename Row, typename Get>
void add_w_test(Fields<Row>& fields, const std::string& key, const std::string& meaning, const std::string& title,
                Get test) {
  std::string column = key;
  std::replace(column.begin(), column.end(), '.', '_');
  fields.push_back(
      Field<Row>(key + ".w", meaning, [test](const Row& r) { return test(r).w; }, {.title = title + " W"}));
  fields.push_back(Field<Row>(key + ".p", "p of " + column + "_w", [test](const Row& r) { return test(r).p; },
                              {.title = title + " p", .shown = Shown::p_value}));
  fields.push_back(Field<Row>(key + ".status", "ok, or why " + column + "_w is undefined",
                              [test](const Row& r) { return status_text(test(r).status); }));
}

template <typename Row, typename Get>
Field<Row> p_field(std::string_view key, std::string_view meaning, Get get, std::string_view title = "p") {
  return {key, meaning, get, {.title = title, .shown = Shown::p_value}};
}

}  // namespace jnd
