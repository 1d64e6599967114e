#include "runner/calc/calc_group_input.h"

#include <cstddef>
#include <map>
#include <utility>

#include <fmt/format.h>

namespace jnd {

namespace {

// Names in the order of their first row, and where that is.
class Names {
 public:
  std::size_t add(const CsvTable& csv, std::size_t row, const char* column) {
    const std::string name(csv.text(row, column));
    if (name.empty()) csv.fail(row, column, "is empty", "every row names its " + std::string(column));
    const auto [place, added] = places_.try_emplace(name, names.size());
    if (added) {
      names.push_back(name);
      first_rows.push_back(row);
    }
    return place->second;
  }
  std::vector<std::string> names;
  std::vector<std::size_t> first_rows;

 private:
  std::map<std::string, std::size_t> places_;
};

// "P3 (no SV), P7 (no S, no V)", at the first of them.
void refuse_incomplete(const CsvTable& csv, const Names& participants, const Names& conditions,
                       const std::map<std::pair<std::size_t, std::size_t>, double>& cells) {
  constexpr std::size_t kNamed = 5;
  std::vector<std::string> incomplete;
  std::size_t first = 0;
  for (std::size_t i = 0; i < participants.names.size(); ++i) {
    std::string missing;
    for (std::size_t j = 0; j < conditions.names.size(); ++j)
      if (!cells.contains({i, j})) missing += (missing.empty() ? "no " : ", no ") + conditions.names[j];
    if (missing.empty()) continue;
    if (incomplete.empty()) first = i;
    incomplete.push_back(fmt::format("{} ({})", participants.names[i], missing));
  }
  if (incomplete.empty()) return;
  std::string who;
  for (std::size_t i = 0; i < incomplete.size() && i < kNamed; ++i) who += (i > 0 ? ", " : "") + incomplete[i];
  if (incomplete.size() > kNamed) who += fmt::format(" and {} more", incomplete.size() - kNamed);
  csv.fail(participants.first_rows[first], "participant",
           fmt::format("{} of {} participants lack{} a value: {}", incomplete.size(), participants.names.size(),
                       incomplete.size() == 1 ? "s" : "", who),
           "add the missing rows, or leave out every row of these participants and say so in the report");
}

}  // namespace

LongTable long_table(const CsvTable& csv) {
  Names participants, conditions;
  std::map<std::pair<std::size_t, std::size_t>, double> cells;
  for (std::size_t row = 0; row < csv.rows(); ++row) {
    const std::size_t i = participants.add(csv, row, "participant"), j = conditions.add(csv, row, "condition");
    const double value = csv.number(row, "value", kGroupValues);
    if (!cells.try_emplace({i, j}, value).second)
      csv.fail(row, "participant",
               fmt::format("{} has a second value under {}", participants.names[i], conditions.names[j]),
               "keep one row for each participant and condition: delete one of the two, or give their mean");
  }
  if (conditions.names.size() < 2)
    csv.fail(0, "condition", fmt::format("{} is the only condition", conditions.names.front()),
             "a comparison needs at least two");
  if (conditions.names.size() > 1000)
    csv.fail(conditions.first_rows[1000], "condition", "is condition number 1001", "at most 1000 are compared");
  refuse_incomplete(csv, participants, conditions, cells);

  LongTable table;
  table.values.n = participants.names.size();
  table.values.k = conditions.names.size();
  for (const auto& [cell, value] : cells) table.values.values.push_back(value);  // sorted: by participant, condition
  table.participants = std::move(participants.names);
  table.conditions = std::move(conditions.names);
  return table;
}

namespace {

// Of participants with one value each: the condition is that of the whole group.
void refuse_second_factor(const CsvTable& csv, const Names& participants, const Names& groups,
                          const std::vector<std::size_t>& group_of) {
  std::map<std::size_t, std::string> condition_of;
  for (std::size_t i = 0; i < participants.names.size(); ++i) {
    const std::size_t row = participants.first_rows[i];
    const std::string condition(csv.text(row, "condition"));
    const std::string& first = condition_of.try_emplace(group_of[i], condition).first->second;
    if (first != condition)
      csv.fail(
          row, "condition",
          fmt::format("group {} has {} and {}, and each participant has one of them", groups.names[group_of[i]], first,
                      condition),
          "a comparison has one factor between participants: name group and condition together in the column group");
  }
}

}  // namespace

GroupedLongTable grouped_table(const CsvTable& csv) {
  Names participants, conditions, groups;
  std::map<std::pair<std::size_t, std::size_t>, double> cells;
  GroupedLongTable table;
  std::vector<std::size_t>& group_of = table.values.group;
  const bool named = csv.has("condition");
  if (!named) conditions.names = {"all"};
  for (std::size_t row = 0; row < csv.rows(); ++row) {
    const std::size_t i = participants.add(csv, row, "participant");
    const std::size_t j = named ? conditions.add(csv, row, "condition") : 0;
    const std::size_t group = groups.add(csv, row, "group");
    if (i == group_of.size()) group_of.push_back(group);
    if (group_of[i] != group)
      csv.fail(row, "group",
               fmt::format("{} is in two groups: {} and {}", participants.names[i], groups.names[group_of[i]],
                           groups.names[group]),
               "a participant belongs to one group; what every participant has is a condition");
    if (!cells.try_emplace({i, j}, csv.number(row, "value", kGroupValues)).second)
      csv.fail(row, "participant",
               fmt::format("{} has a second value under {}", participants.names[i], conditions.names[j]),
               "keep one row for each participant and condition: delete one of the two, or give their mean");
  }
  if (groups.names.size() < 2)
    csv.fail(0, "group", fmt::format("{} is the only group", groups.names.front()),
             "leave the column out, or add the participants of the others");
  if (groups.names.size() > 1000 || conditions.names.size() > 1000)
    csv.fail(0, "group", "there are more than 1000 groups or conditions", "at most 1000 of each are compared");
  const bool between = cells.size() == participants.names.size();
  if (between && named)
    refuse_second_factor(csv, participants, groups, group_of);
  else if (!between)
    refuse_incomplete(csv, participants, conditions, cells);
  table.values.groups = groups.names.size();
  table.values.values.n = participants.names.size();
  table.values.values.k = between ? 1 : conditions.names.size();
  for (const auto& [cell, value] : cells) table.values.values.values.push_back(value);  // by participant, condition
  table.groups = std::move(groups.names);
  table.conditions = std::move(conditions.names);
  return table;
}

std::vector<PairedColumn> paired_columns(const CsvTable& csv) {
  Names items;
  std::vector<PairedColumn> columns;
  if (!csv.has("item")) columns.emplace_back();
  for (std::size_t row = 0; row < csv.rows(); ++row) {
    std::size_t place = 0;
    if (csv.has("item")) {
      place = items.add(csv, row, "item");
      if (place == columns.size()) columns.push_back({items.names.back(), {}, {}});
    }
    columns[place].x.push_back(csv.number(row, "x", kGroupValues));
    columns[place].y.push_back(csv.number(row, "y", kGroupValues));
  }
  return columns;
}

}  // namespace jnd
