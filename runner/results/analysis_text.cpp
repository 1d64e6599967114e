#include "runner/results/analysis_text.h"

#include <fmt/format.h>

#include "runner/terminal/terminal.h"
#include "runner/terminal/text_table.h"

namespace jnd {

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
  std::string all = bold(table.title) + "\n";
  if (!table.note.empty()) all += dim(table.note) + "\n";
  all += text.text();
  for (const std::string& note : table.footnotes) all += fmt::format("  {}\n", printable(note));
  return all + "\n";
}

void print_table(const ResultTable& table) {
  fmt::print("{}", text_of(table));
}

void print_cautions(const StudyResults& results) {
  for (const std::string& one : results.deviations) fmt::print("{}\n", warn("deviation: " + printable(one)));
  for (const std::string& one : results.cautions) fmt::print("{}\n", warn("caution: " + printable(one)));
}

}  // namespace jnd
