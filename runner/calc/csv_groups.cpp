#include "runner/calc/csv_groups.h"

#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "runner/terminal/terminal.h"

namespace jnd {

std::vector<RowGroup> row_groups(const CsvTable& table) {
  std::vector<RowGroup> groups;
  std::map<std::optional<std::string>, std::size_t> places;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    std::optional<std::string> name;
    if (table.has("group")) name = table.text(row, "group");
    const auto [place, added] = places.try_emplace(name, groups.size());
    if (added) groups.push_back({name, {}});
    groups[place->second].rows.push_back(row);
  }
  return groups;
}

nlohmann::ordered_json name_json(const RowGroup& group) {
  return group.name ? nlohmann::ordered_json(*group.name) : nlohmann::ordered_json(nullptr);
}

std::string name_text(const RowGroup& group) {
  return printable(group.name.value_or("all"));
}

void add_count(const CsvTable& table, std::size_t row, int& sum) {
  constexpr int kMost = 1'000'000'000;
  const int n = table.integer(row, "n", 0, kMost);
  if (n > kMost - sum)
    table.fail(row, "n", "more than a thousand million answers of one kind", "leave out rows that were counted twice");
  sum += n;
}

}  // namespace jnd
