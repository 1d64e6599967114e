// Rows of a CSV file by the groups that an optional column names, and what the answers to them share.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "protocols/input/csv_table.h"

namespace jnd {

// Rows of one group, in the order of the file; without the column one group without a name.
struct RowGroup {
  std::optional<std::string> name;
  std::vector<std::size_t> rows;
};
// Groups in the order of their first row.
std::vector<RowGroup> row_groups(const CsvTable& table);

nlohmann::ordered_json name_json(const RowGroup& group);  // null without a name
std::string name_text(const RowGroup& group);             // "all" without a name; printable

// Adds the count in column n of a row to sum. Throws InputError, located, where it is not a whole number of 0 or more,
// or the sum would pass a thousand million.
void add_count(const CsvTable& table, std::size_t row, int& sum);

}  // namespace jnd
