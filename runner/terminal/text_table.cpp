#include "runner/terminal/text_table.h"

#include <algorithm>
#include <utility>

namespace jnd {

TextTable::TextTable(std::vector<std::string> header, std::vector<Align> align) : align_(std::move(align)) {
  rows_.push_back(std::move(header));
}

void TextTable::add(std::vector<std::string> row) {
  row.resize(align_.size());
  rows_.push_back(std::move(row));
}

void TextTable::rule() {
  rows_.emplace_back();
}

std::string TextTable::text() const {
  std::vector<std::size_t> widths(align_.size(), 0);
  for (const auto& row : rows_)
    for (std::size_t column = 0; column < row.size(); ++column)
      widths[column] = std::max(widths[column], display_width(row[column]));
  std::string text;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    std::string line;
    for (std::size_t column = 0; column < rows_[i].size(); ++column) {
      const std::string padding(widths[column] - display_width(rows_[i][column]), ' ');
      line += column == 0 ? "  " : "   ";
      line += align_[column] == Align::left ? rows_[i][column] + padding : padding + rows_[i][column];
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += (i == 0 ? bold(line) : line) + "\n";
  }
  return text;
}

}  // namespace jnd
