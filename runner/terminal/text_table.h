// Tables of text for people: columns as wide as their cells, numbers to the right.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "runner/terminal/terminal.h"

namespace jnd {

class TextTable {
 public:
  enum class Align { left, right };
  // align is one entry a column; header.size() == align.size().
  TextTable(std::vector<std::string> header, std::vector<Align> align);

  void add(std::vector<std::string> row);  // as many cells as the header has
  void rule();                             // a blank line between groups of rows
  // Each line indented by two spaces and ended by a newline. width: columns that there are, 0: as many as it takes. Where
  // it takes more, headers are broken into lines and gaps narrowed; then words in the last column stand below their
  // row; then columns stand below each other, those of the first words beside every one of them again. Words are never
  // broken.
  std::string text(std::size_t width) const;
  std::string text() const { return text(table_width()); }

 private:
  using Columns = std::vector<std::size_t>;  // places of columns
  struct Layout {
    std::vector<std::size_t> widths;  // by column
    std::size_t gap = 3;              // between columns
    std::size_t width = 0;            // that there is; 0: without end
    bool fits(const Columns& columns) const;
  };
  std::vector<std::size_t> widths(bool broken_headers) const;
  std::vector<Columns> parts(const Columns& all, const Layout& layout) const;
  std::size_t keys_of(const Columns& all, const Layout& layout) const;
  // below: a column whose words stand below each row. stacked_keys: rows with nothing behind so many columns are left
  // out; 0: none.
  std::string part(const Columns& columns, const Layout& layout, std::optional<std::size_t> below = {},
                   std::size_t stacked_keys = 0) const;
  std::string header(const Columns& columns, const Layout& layout) const;
  std::string line(const Columns& columns, const std::vector<std::string>& cells, const Layout& layout) const;

  std::vector<Align> align_;
  std::vector<std::vector<std::string>> rows_;  // the header first; an empty row is a rule
};

}  // namespace jnd
