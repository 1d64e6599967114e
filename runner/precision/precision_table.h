// A table of the planner, for a terminal or in Markdown: the first column to the left, numbers to the right.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace jnd {

enum class TableStyle { terminal, markdown };

class PrecisionTable {
 public:
  explicit PrecisionTable(std::vector<std::string> header) : rows_{std::move(header)} {}
  void add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }
  std::string text(TableStyle style) const;

 private:
  std::string markdown() const;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace jnd
