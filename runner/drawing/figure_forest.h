// Estimates below one another, each with its interval, its name at the left and its numbers at the right.
#pragma once

#include <string>
#include <vector>

#include "runner/drawing/svg.h"

namespace jnd {

struct ForestRow {
  std::string name;          // at the left, once where the columns stand side by side
  double value = 0;          // NaN: a cross at the rule
  double low = 0, high = 0;  // of its interval; not finite: it has none; of ratios 0 and infinity are open ends
  std::string numbers;       // at the right, where the forest has room for them
  std::string words;         // tooltip
  bool of_group = true;      // of everyone: a full mark; otherwise a small one
};

// One quantity: of the columns of a forest each has the same rows.
struct ForestColumn {
  std::string title, x_title;  // title: above it; may be empty
  std::vector<ForestRow> rows;
};

struct Forest {
  std::string id, title, description;  // of the picture
  // Widths at the left, of a column, at its right, between columns; height of a row.
  double names = 190, plot = 380, numbers = 250, between = 24, row = 34;
  bool ratios = false;  // values > 0 on a logarithmic scale
  std::vector<ForestColumn> columns;
};

// Each column with zero in its range (of ratios: one), and a rule there. side_by_side: otherwise below one another, each with its names.
Svg draw_forest(const Forest& forest, bool side_by_side = true);

}  // namespace jnd
