// The reference numbers of the group statistics, and tables made by rapidcheck.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <rapidcheck.h>

#include "analysis/group/within_table.h"
#include "analysis/numerics/special_values.h"
#include "analysis/selftest/reference_numbers.h"

namespace jnd {

inline const nlohmann::json& group_reference() {
  return reference_numbers("group");
}

inline WithinTable table_of(const nlohmann::json& data) {
  WithinTable table;
  table.n = data.size();
  table.k = data.at(0).size();
  for (const auto& row : data)
    for (const auto& value : row) table.values.push_back(value.get<double>());
  return table;
}

inline std::vector<double> numbers_of(const nlohmann::json& list) {
  return list.get<std::vector<double>>();
}

// |found - reference| / |reference|; 0 where both are 0.
inline double relative(double found, double reference) {
  return found == reference ? 0 : std::abs(found - reference) / std::max(std::abs(reference), 1e-300);
}

// n x k whole numbers 0..steps plus a little of each participant and condition: with ties, never constant for long.
inline WithinTable random_table(std::size_t least_n, std::size_t least_k, int steps) {
  WithinTable table;
  table.n = *rc::gen::inRange<std::size_t>(least_n, least_n + 12);
  table.k = *rc::gen::inRange<std::size_t>(least_k, least_k + 4);
  for (std::size_t i = 0; i < table.n * table.k; ++i) table.values.push_back(*rc::gen::inRange(0, steps + 1));
  return table;
}

// Participants and conditions in another order: row i comes from rows[i], column j from columns[j].
inline WithinTable permuted(const WithinTable& table, const std::vector<std::size_t>& rows,
                            const std::vector<std::size_t>& columns) {
  WithinTable result;
  result.n = table.n;
  result.k = table.k;
  for (const std::size_t i : rows)
    for (const std::size_t j : columns) result.values.push_back(table.at(i, j));
  return result;
}

inline std::vector<std::size_t> random_order(std::size_t size) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < size; ++i) order.push_back(i);
  for (std::size_t i = size; i-- > 1;) std::swap(order[i], order[*rc::gen::inRange<std::size_t>(0, i + 1)]);
  return order;
}

}  // namespace jnd
