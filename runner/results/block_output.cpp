#include "runner/results/block_output.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "data/fields/number_text.h"
#include "runner/terminal/json_output.h"
#include "runner/terminal/terminal.h"
#include "runner/terminal/text_table.h"

namespace jnd {

namespace {

using Json = nlohmann::ordered_json;

std::string number_of(double value, const FieldCore& field, int decimals) {
  if (field.shown == Shown::percent) return percent_text(value);
  if (field.shown == Shown::p_value) return p_value_text(value);
  if (field.shown == Shown::given) return std::isnan(value) ? "-" : fmt::format("{:.6g}", value);
  if (field.limit > 0 && value > field.limit) return "> " + field.limit_text;
  return number_text(field.factor * value, decimals);
}

std::string text_of_value(const FieldValue& value, const FieldCore& field, int decimals) {
  if (const auto* number = std::get_if<double>(&value)) return number_of(*number, field, decimals);
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  return csv_value(value);
}

bool is_interval(const TableColumn& column) {
  return column.between == " to ";
}

// Of a number of this size; below 0 where nothing follows from it.
int decimals_of_number(double size) {
  return std::isfinite(size) && size != 0 ? decimals_of_size(std::abs(size)) : -1;
}

// Of half the interval's width; where one end is open or beyond what can be told, of the size of the other; below 0 where
// both are.
int decimals_of_interval(const Block& block, std::size_t row, const TableColumn& column) {
  const FieldCore& field = block.field(column.key);
  const double low = field.factor * block.number(row, column.key),
               high = field.factor * block.number(row, column.second);
  const bool open = !std::isfinite(high) || (field.limit > 0 && high / field.factor > field.limit);
  if (open) return decimals_of_number(low);
  return std::isfinite(low) ? decimals_of_spread((high - low) / 2) : decimals_of_number(high);
}

// Counts and levels that are whole numbers in every row.
bool is_whole(const Block& block, const std::string& key) {
  const FieldCore& field = block.field(key);
  for (std::size_t row = 0; row < block.rows(); ++row) {
    const double value = field.factor * block.number(row, key);
    if (!std::isnan(value) && value != std::round(value)) return false;
  }
  return true;
}

// Of the number in a row, from the interval that it is an end of or that stands beside it, else from its own size; below 0
// where neither says anything.
int own_decimals(const Block& block, std::size_t row, const std::string& key, const TableColumn* interval) {
  if (interval != nullptr && !std::isnan(block.number(row, interval->key)))
    return decimals_of_interval(block, row, *interval);
  const FieldCore& field = block.field(key);
  const double value = block.number(row, key);
  return field.limit > 0 && value > field.limit ? -1 : decimals_of_number(field.factor * value);
}

// Decimals of a field in every row, empty where its numbers are not shown by size: the same in all rows of one outcome, so
// that they stand under one another. The most that one of them needs, but at most one more than the middle one does.
std::vector<int> decimals_of(const Block& block, const std::string& key, const TableColumn* interval) {
  if (key.empty() || block.field(key).shown != Shown::number) return {};
  std::vector<int> decimals(block.rows(), 0);
  if (interval == nullptr && is_whole(block, key)) return decimals;
  std::map<std::string, std::vector<int>> needed;
  const auto scale_of = [&](std::size_t row) { return block.has("outcome") ? block.text(row, "outcome") : ""; };
  for (std::size_t row = 0; row < block.rows(); ++row)
    if (const int own = own_decimals(block, row, key, interval); own >= 0) needed[scale_of(row)].push_back(own);
  for (auto& [scale, all] : needed) std::sort(all.begin(), all.end());
  for (std::size_t row = 0; row < block.rows(); ++row)
    if (const std::vector<int>& all = needed[scale_of(row)]; !all.empty())
      decimals[row] = std::min(all.back(), all[(all.size() - 1) / 2] + 1);
  return decimals;
}

// Of the two fields of a column.
using ColumnDecimals = std::pair<std::vector<int>, std::vector<int>>;

ColumnDecimals decimals_of_column(const Block& block, const std::vector<TableColumn>& columns, std::size_t place) {
  const TableColumn& column = columns[place];
  const TableColumn* interval = is_interval(column) ? &column : nullptr;
  if (column.between.empty() && place + 1 < columns.size() && is_interval(columns[place + 1]))
    interval = &columns[place + 1];
  return {decimals_of(block, column.key, interval), decimals_of(block, column.second, interval)};
}

std::string cell_of(const Block& block, std::size_t row, const TableColumn& column, const ColumnDecimals& decimals) {
  const auto text = [&](const std::string& key, const std::vector<int>& of_rows) {
    const FieldCore& field = block.field(key);
    return text_of_value(block.value(row, field), field, of_rows.empty() ? 0 : of_rows[row]);
  };
  std::string a = text(column.key, decimals.first);
  if (column.between.empty()) return a;
  const std::string b = text(column.second, decimals.second);
  if (is_interval(column)) return range_text(a, b);
  return b.empty() ? a : (a.empty() ? "-" : a) + column.between + b;
}

// Columns in which no row has something; an interval has nothing where there is none, "0 of 0" of a thing that was not done.
void drop_empty_columns(ResultTable& table, const std::vector<TableColumn>& columns) {
  for (std::size_t column = table.columns.size(); column-- > 1;) {
    const std::string none = columns[column].between.empty() ? "" : "0" + columns[column].between + "0";
    const auto empty = [&, interval = is_interval(columns[column])](const auto& row) {
      return row[column].empty() || (interval && row[column] == "-") || (!interval && row[column] == none);
    };
    if (!std::all_of(table.rows.begin(), table.rows.end(), empty)) continue;
    table.columns.erase(table.columns.begin() + static_cast<std::ptrdiff_t>(column));
    for (auto& row : table.rows) row.erase(row.begin() + static_cast<std::ptrdiff_t>(column));
  }
}

ResultTable made(const Block& block, std::string title, std::string note, const std::vector<TableColumn>& columns,
                 const std::string& only) {
  ResultTable table{block.id, std::move(title), std::move(note)};
  for (const TableColumn& column : columns) {
    const FieldCore& field = block.field(column.key);
    table.columns.push_back({column.title.empty() ? field.title : column.title, field.number});
  }
  if (columns.empty()) return table;
  std::vector<ColumnDecimals> decimals;
  for (std::size_t place = 0; place < columns.size(); ++place)
    decimals.push_back(decimals_of_column(block, columns, place));
  for (std::size_t row = 0; row < block.rows(); ++row) {
    if (!only.empty() && !block.flag(row, only)) continue;
    std::vector<std::string>& cells = table.rows.emplace_back();
    for (std::size_t place = 0; place < columns.size(); ++place)
      cells.push_back(cell_of(block, row, columns[place], decimals[place]));
  }
  drop_empty_columns(table, columns);
  if (table.columns.size() > 1 && !table.columns.front().number)
    for (std::size_t i = table.rows.size(); i-- > 1;)
      if (table.rows[i].front() == table.rows[i - 1].front()) table.rows[i].front().clear();
  table.footnotes = block.footnotes;
  return table;
}

std::size_t text_columns() {
  constexpr std::size_t kMost = 80;
  return table_width() == 0 ? kMost : std::min(kMost, table_width());
}

}  // namespace

ResultTable table_of(const Block& block) {
  return made(block, block.title, block.note, block.columns, "");
}

ResultTable answer_of(const Block& block) {
  return made(block, block.answer.title, block.answer.note, block.answer.columns, block.answer.only);
}

Json json_value(const FieldValue& value) {
  struct Made {
    Json operator()(std::monostate) const { return nullptr; }
    Json operator()(bool flag) const { return flag; }
    Json operator()(std::int64_t number) const { return number; }
    Json operator()(double number) const { return json_number(number); }
    Json operator()(const std::string& text) const { return text.empty() ? Json(nullptr) : Json(text); }
    Json operator()(const std::vector<double>& numbers) const { return json_numbers(numbers); }
  };
  return std::visit(Made{}, value);
}

void set_json(Json& out, std::string_view key, Json value) {
  Json* place = &out;
  for (std::size_t dot; (dot = key.find('.')) != std::string_view::npos; key.remove_prefix(dot + 1))
    place = &(*place)[std::string(key.substr(0, dot))];
  (*place)[std::string(key)] = std::move(value);
}

Json json_row(const Block& block, std::size_t row) {
  Json out = Json::object();
  for (const FieldCore& field : block.fields)
    if (field.place == Place::everywhere) set_json(out, field.key, json_value(block.value(row, field)));
  return out;
}

Json json_rows(const Block& block) {
  Json out = Json::array();
  for (std::size_t row = 0; row < block.rows(); ++row) out.push_back(json_row(block, row));
  return out;
}

std::string paragraph(const std::string& text, std::string_view indent, std::string (*style)(std::string_view)) {
  std::string all;
  for (const std::string& line : wrapped_words(printable(text), text_columns() - indent.size()))
    all += fmt::format("{}{}\n", indent, style == nullptr ? line : style(line));
  return all;
}

std::string text_of(const ResultTable& table) {
  std::vector<std::string> header;
  std::vector<TextTable::Align> align;
  for (const ResultTable::Column& column : table.columns) {
    header.push_back(column.name);
    align.push_back(column.number ? TextTable::Align::right : TextTable::Align::left);
  }
  TextTable text(header, align);
  for (const std::vector<std::string>& row : table.rows) {
    std::vector<std::string> cells;
    for (const std::string& cell : row) cells.push_back(printable(cell));
    text.add(cells);
  }
  std::string all = table.title.empty() ? "" : paragraph(table.title, "", bold);
  if (!table.note.empty()) all += paragraph(table.note, "", dim);
  all += text.text();
  for (const std::string& note : table.footnotes) all += paragraph(note, "  ");
  return all + "\n";
}

}  // namespace jnd
