#include "runner/results/answer_tables.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "data/methods/markdown_text.h"
#include "runner/results/result_format.h"
#include "runner/results/result_table_parts.h"
#include "runner/results/result_tables_questionnaire.h"

namespace jnd {

namespace {

// A column of a table, and what it is called in the answer.
struct Chosen {
  std::string name, as{};
};

std::size_t place_of(const ResultTable& table, const std::string& name) {
  const auto found = std::find_if(table.columns.begin(), table.columns.end(),
                                  [&](const ResultTable::Column& column) { return column.name == name; });
  return static_cast<std::size_t>(found - table.columns.begin());
}

// With these columns only, in this order; those that the table has not are passed over.
ResultTable with_columns(ResultTable table, const std::vector<Chosen>& chosen) {
  std::vector<std::size_t> places;
  std::vector<ResultTable::Column> columns;
  for (const auto& [name, as] : chosen) {
    const std::size_t place = place_of(table, name);
    if (place == table.columns.size()) continue;
    places.push_back(place);
    columns.push_back({as.empty() ? name : as, table.columns[place].number});
  }
  ResultTable narrow = std::move(table);
  narrow.columns = std::move(columns);
  for (std::vector<std::string>& row : narrow.rows) {
    const std::vector<std::string> cells = std::exchange(row, {});
    for (const std::size_t place : places) row.push_back(cells[place]);
  }
  return narrow;
}

// The rows that carry the mark of what is registered, in a column that says of what they are.
ResultTable registered_rows(ResultTable table, const std::string& column) {
  const std::size_t place = place_of(table, column);
  std::erase_if(table.rows, [&](const auto& row) { return !row[place].ends_with(" *"); });
  return table;
}

// "d' per 100 N/m" of "d' per 100 N/m *", where all rows say the same; then the column need not.
std::string said_once(const ResultTable& table, const std::string& column) {
  const std::size_t place = place_of(table, column);
  if (table.rows.empty()) return {};
  const std::string& first = table.rows.front()[place];
  const bool alike =
      std::all_of(table.rows.begin(), table.rows.end(), [&](const auto& row) { return row[place] == first; });
  return alike ? first.substr(0, first.size() - 2) : std::string();
}

struct ConditionsAnswered {
  const StudyResults& results;
  const Protocol& protocol;

  ResultTable operator()(const ConstantResults& measured) const {
    ResultTable table = group_table(measured.analysis, protocol);
    const std::string jnd = fmt::format("JND {}", unit_of(protocol));
    table = with_columns(std::move(table), {{"condition"},
                                            {"n used"},
                                            {"mean " + jnd, jnd},
                                            {"95 % CI"},
                                            {"mean Weber", "Weber"},
                                            {"published JND", "published"}});
    for (std::vector<std::string>& row : table.rows)
      if (row[2] == "-") row[2] = "none";  // the notes below say why
    table.title = "JND by condition: the mean over participants";
    return table;
  }
  ResultTable operator()(const AdaptiveResults& measured) const { return adaptive_group_table(measured, protocol); }
  ResultTable operator()(const MeasuredTask& measured) const {
    ResultTable table = registered_rows(task_group_table(results, measured.task, protocol), "measure");
    const std::string measure = said_once(table, "measure");
    table = with_columns(std::move(table),
                         {{"condition"}, {"standard"}, {"n used"}, {"mean"}, {"95 % CI"}, {"median"}, {"published"}});
    table.title = capitalised(measure) + " by condition";
    table.note =
        fmt::format("{}; mean with Student's 95 % interval", measured.task.outcomes[measured.task.registered].meaning);
    return table;
  }
  ResultTable operator()(const ExplorationResults&) const { return {}; }
};

}  // namespace

std::vector<ResultTable> answer_tables(const StudyResults& results, const Protocol& protocol) {
  std::vector<ResultTable> tables;
  if (const auto* explored = std::get_if<ExplorationResults>(&results.measured)) {
    tables = questionnaire_tables(results.questionnaire, *explored, protocol);
  } else {
    tables = {std::visit(ConditionsAnswered{results, protocol}, results.measured),
              contrasts_table(results, protocol, ContrastScales::registered), groups_table(results, protocol),
              between_table(results, protocol)};
  }
  std::erase_if(tables, [](const ResultTable& table) { return table.rows.empty(); });
  return tables;
}

std::string who_took_part(const StudyResults& results, const Protocol& protocol) {
  const Attendance& attendance = attendance_of(results);
  return fmt::format("{} {} participant{} ({} planned){}", attendance.participants, to_string(attendance.kind),
                     attendance.participants == 1 ? "" : "s", protocol.design.participants,
                     std::holds_alternative<ExplorationResults>(results.measured) ? " after free interaction" : "");
}

}  // namespace jnd
