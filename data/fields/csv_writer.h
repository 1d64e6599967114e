// CSV as RFC 4180 has it, with LF, UTF-8 without BOM, and numbers that no locale touches.
//
// A table is a list of columns, each with its meaning: the file and its part of dictionary.csv come from the same list,
// so that the dictionary cannot say anything else than the file.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "data/study/problem.h"

namespace jnd {

// A number's shortest decimal form that reads back the same (std::to_chars); NaN is an empty cell, infinities are Inf
// and -Inf.
std::string csv_number(double value);
std::string csv_number(std::int64_t value);
inline std::string csv_number(int value) {
  return csv_number(static_cast<std::int64_t>(value));
}
inline std::string csv_flag(bool value) {
  return value ? "1" : "0";
}
// Text that people typed or named. A spreadsheet runs cells that begin with = + - @ (or a tab, return or line feed),
// also in their full-width forms and behind quotes or blanks of any kind (look_alikes.h): those get an apostrophe in
// front. Numbers stay numbers: neither those of csv_number get one, nor a text that is nothing but a number, such as
// the answer -3.
std::string csv_text(std::string_view text);
// A finished cell, quoted where RFC 4180 asks for it.
std::string csv_cell(std::string_view cell);
// Cells joined by commas, with a line feed.
std::string csv_line(const std::vector<std::string>& cells);

// What the cells of a column are, in the words of Table Schema (https://datapackage.org). An empty cell is a missing
// value, whatever the type.
enum class CellType {
  text,
  integer,
  number,  // decimals, Inf and -Inf
  flag,    // 0 or 1
  time     // ISO 8601, UTC
};
std::string_view to_string(CellType type) noexcept;  // "string", "integer", "number", "boolean", "datetime"

template <typename Row>
struct CsvColumn {
  std::string name;
  std::string meaning;
  std::string unit;    // empty for text and counts
  std::string levels;  // of text columns: the values that occur, or empty
  std::function<std::string(const Row&)> cell;
  Reveals reveals = Reveals::plan;  // of a blinded study
  CellType type = CellType::text;
  bool several = false;  // a cell may hold several of the levels, separated by blanks
};

// Those that may be seen while the study is blinded.
template <typename Row>
std::vector<CsvColumn<Row>> blinded(std::vector<CsvColumn<Row>> columns) {
  std::erase_if(columns, [](const CsvColumn<Row>& column) { return column.reveals != Reveals::nothing; });
  return columns;
}

template <typename Row>
std::string csv_header(const std::vector<CsvColumn<Row>>& columns) {
  std::vector<std::string> cells;
  for (const auto& column : columns) cells.push_back(column.name);
  return csv_line(cells);
}

template <typename Row>
std::string csv_row(const std::vector<CsvColumn<Row>>& columns, const Row& row) {
  std::vector<std::string> cells;
  for (const auto& column : columns) cells.push_back(column.cell(row));
  return csv_line(cells);
}

template <typename Row>
std::string csv_table(const std::vector<CsvColumn<Row>>& columns, const std::vector<Row>& rows) {
  std::string text = csv_header(columns);
  for (const Row& row : rows) text += csv_row(columns, row);
  return text;
}

// A line of dictionary.csv, and a field of datapackage.json.
struct DictionaryRow {
  std::string file, column, meaning, unit, levels;
  CellType type = CellType::text;
  bool several = false;
};

template <typename Row>
void describe(const std::string& file, const std::vector<CsvColumn<Row>>& columns, std::vector<DictionaryRow>& rows) {
  for (const auto& column : columns)
    rows.push_back({file, column.name, column.meaning, column.unit, column.levels, column.type, column.several});
}

}  // namespace jnd
