#include "runner/precision/precision_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "runner/terminal/text_table.h"

namespace jnd {

std::string PrecisionTable::text(TableStyle style) const {
  if (style == TableStyle::markdown) return markdown();
  std::vector<TextTable::Align> align(rows_.front().size(), TextTable::Align::right);
  align.front() = TextTable::Align::left;
  TextTable table(rows_.front(), align);
  for (std::size_t i = 1; i < rows_.size(); ++i) table.add(rows_[i]);
  return table.text();
}

std::string PrecisionTable::markdown() const {
  std::string text;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    text += fmt::format("| {} |\n", fmt::join(rows_[i], " | "));
    if (i != 0) continue;
    text += "|---";
    for (std::size_t column = 1; column < rows_[i].size(); ++column) text += "|---:";
    text += "|\n";
  }
  return text;
}

}  // namespace jnd
