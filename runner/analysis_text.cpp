#include "runner/analysis_text.h"

#include <fmt/format.h>

#include "runner/terminal.h"
#include "runner/text_table.h"

namespace jnd {

void print_table(const ResultTable& table) {
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
  fmt::print("{}\n", bold(table.title));
  if (!table.note.empty()) fmt::print("{}\n", dim(table.note));
  fmt::print("{}", text.text());
  for (const std::string& remark : table.remarks) fmt::print("  {}\n", printable(remark));
  fmt::print("\n");
}

void print_remarks(const StudyResults& results) {
  for (const std::string& one : results.deviations) fmt::print("{}\n", warn("deviation: " + printable(one)));
  for (const std::string& one : results.warnings) fmt::print("{}\n", warn("caution: " + printable(one)));
}

}  // namespace jnd
