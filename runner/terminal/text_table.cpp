#include "runner/terminal/text_table.h"

#include <algorithm>
#include <numeric>
#include <sstream>
#include <utility>

namespace jnd {

namespace {

constexpr std::size_t kIndent = 2, kNarrowGap = 2;

std::size_t longest_word(const std::string& text) {
  std::istringstream words(text);
  std::size_t longest = 0;
  for (std::string word; words >> word;) longest = std::max(longest, display_width(word));
  return longest;
}

bool all_empty(const std::vector<std::string>& cells, std::size_t from) {
  return std::all_of(cells.begin() + static_cast<std::ptrdiff_t>(from), cells.end(),
                     [](const std::string& cell) { return cell.empty(); });
}

}  // namespace

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

std::vector<std::size_t> TextTable::widths(bool broken_headers) const {
  std::vector<std::size_t> widths(align_.size(), 0);
  for (std::size_t i = 0; i < rows_.size(); ++i)
    for (std::size_t column = 0; column < rows_[i].size(); ++column)
      widths[column] = std::max(
          widths[column], i == 0 && broken_headers ? longest_word(rows_[i][column]) : display_width(rows_[i][column]));
  return widths;
}

bool TextTable::Layout::fits(const Columns& columns) const {
  if (width == 0) return true;
  std::size_t sum = kIndent;
  for (const std::size_t column : columns) sum += widths[column] + (column == columns.front() ? 0 : gap);
  return sum <= width;
}

// The first columns of words say what a row is about: they stand in every part.
std::size_t TextTable::keys_of(const Columns& all, const Layout& layout) const {
  Layout half = layout;
  half.width /= 2;
  Columns keys;
  for (const std::size_t column : all) {
    keys.push_back(column);
    if (keys.size() == all.size() || align_[column] != Align::left || !half.fits(keys)) return keys.size() - 1;
  }
  return keys.size();
}

std::vector<TextTable::Columns> TextTable::parts(const Columns& all, const Layout& layout) const {
  const auto after_keys = all.begin() + static_cast<std::ptrdiff_t>(keys_of(all, layout));
  const Columns keys(all.begin(), after_keys);
  std::vector<Columns> parts = {keys};
  for (auto column = after_keys; column != all.end(); ++column) {
    parts.back().push_back(*column);
    if (layout.fits(parts.back()) || parts.back().size() == keys.size() + 1) continue;
    parts.back().pop_back();
    parts.push_back(keys);
    parts.back().push_back(*column);
  }
  return parts;
}

std::string TextTable::line(const Columns& columns, const std::vector<std::string>& cells, const Layout& layout) const {
  std::string line;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::size_t width = layout.widths[columns[i]];
    const std::string padding(width - std::min(display_width(cells[i]), width), ' ');
    line += std::string(i == 0 ? kIndent : layout.gap, ' ');
    line += align_[columns[i]] == Align::left ? cells[i] + padding : padding + cells[i];
  }
  line.erase(line.find_last_not_of(' ') + 1);
  return line;
}

// The last line of each stands just above its column.
std::string TextTable::header(const Columns& columns, const Layout& layout) const {
  std::vector<std::vector<std::string>> heads;
  std::size_t lines = 1;
  for (const std::size_t column : columns) {
    const std::string& head = rows_[0][column];
    heads.push_back(display_width(head) <= layout.widths[column] ? std::vector{head}
                                                                 : wrapped_words(head, layout.widths[column]));
    lines = std::max(lines, heads.back().size());
  }
  std::string text;
  for (std::size_t above = lines; above-- > 0;) {
    std::vector<std::string> cells;
    for (const auto& head : heads) cells.push_back(above < head.size() ? head[head.size() - 1 - above] : "");
    text += bold(line(columns, cells, layout)) + "\n";
  }
  return text;
}

std::string TextTable::part(const Columns& columns, const Layout& layout, std::optional<std::size_t> below,
                            std::size_t stacked_keys) const {
  constexpr std::size_t kBelow = 6;  // its indent
  std::string text = header(columns, layout);
  for (std::size_t i = 1; i < rows_.size(); ++i) {
    std::vector<std::string> cells;
    if (!rows_[i].empty())
      for (const std::size_t column : columns) cells.push_back(rows_[i][column]);
    if (stacked_keys > 0 && !cells.empty() && all_empty(cells, stacked_keys)) continue;
    text += line(columns, cells, layout) + "\n";
    if (!below || rows_[i].empty() || rows_[i][*below].empty()) continue;
    for (const std::string& words : wrapped_words(rows_[i][*below], layout.width - kBelow))
      text += std::string(kBelow, ' ') + words + "\n";
  }
  return text;
}

std::string TextTable::text(std::size_t width) const {
  Columns all(align_.size());
  std::iota(all.begin(), all.end(), 0);
  Layout layout{widths(false), 3, width};
  if (layout.fits(all)) return part(all, layout);
  layout.widths = widths(true);
  if (layout.fits(all)) return part(all, layout);
  layout.gap = kNarrowGap;
  if (layout.fits(all)) return part(all, layout);
  const std::size_t last = all.size() - 1;
  const bool words_last = last > 1 && align_[last] == Align::left;
  if (words_last) all.pop_back();
  const std::optional<std::size_t> below = words_last ? std::optional(last) : std::nullopt;
  std::string text;
  const std::vector<Columns> stacked = parts(all, layout);
  const std::size_t keys = keys_of(all, layout);
  for (const Columns& columns : stacked)
    text += (text.empty() ? "" : "\n") + part(columns, layout, columns == stacked.back() ? below : std::nullopt,
                                              &columns == &stacked.front() ? 0 : keys);
  return text;
}

}  // namespace jnd
