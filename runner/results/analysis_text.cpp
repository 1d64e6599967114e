#include "runner/results/analysis_text.h"

#include <algorithm>

#include <fmt/format.h>

#include "data/methods/verdict_text.h"
#include "runner/results/answer_tables.h"
#include "runner/terminal/terminal.h"
#include "runner/terminal/text_table.h"

namespace jnd {

namespace {

std::size_t text_columns() {
  constexpr std::size_t kMost = 80;
  return table_width() == 0 ? kMost : std::min(kMost, table_width());
}

}  // namespace

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
  std::string all = paragraph(table.title, "", bold);
  if (!table.note.empty()) all += paragraph(table.note, "", dim);
  all += text.text();
  for (const std::string& note : table.footnotes) all += paragraph(note, "  ");
  return all + "\n";
}

std::string answer_text(const StudyResults& results, const Protocol& protocol) {
  std::string text;
  for (const ResultTable& table : answer_tables(results, protocol)) text += text_of(table);
  if (const std::string verdict = verdict_text(results, protocol); !verdict.empty())
    text += paragraph(verdict, "", bold) + "\n";
  return text;
}

std::string cautions_text(const StudyResults& results) {
  std::string text;
  for (const std::string& one : results.deviations) text += paragraph("deviation: " + one, "", warn);
  for (const std::string& one : results.cautions) text += paragraph("caution: " + one, "", warn);
  return text.empty() ? text : text + "\n";
}

}  // namespace jnd
