// Tables of text for people: columns as wide as their cells, numbers to the right.
#pragma once

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
  // Each line indented by two spaces and ended by a newline.
  std::string text() const;

 private:
  std::vector<Align> align_;
  std::vector<std::vector<std::string>> rows_;  // the header first; an empty row is a rule
};

}  // namespace jnd
