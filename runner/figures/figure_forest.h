// Estimates below one another, each with its interval, its name at the left and its numbers at the right.
#pragma once

#include <string>
#include <vector>

#include "runner/figures/svg.h"

namespace jnd {

struct ForestRow {
  std::string name;          // at the left
  double value = 0;          // NaN: a cross at the rule
  double low = 0, high = 0;  // of its interval; not finite: it has none
  std::string numbers;       // at the right
  std::string words;         // tooltip
  bool of_group = true;      // of everyone: a full mark; otherwise a small one
};

struct Forest {
  std::string id, title, description;  // of the picture
  std::string x_title;
  double names = 190, numbers = 250, row = 34;  // width at the left and at the right, height of a row
  std::vector<ForestRow> rows;
};

// With zero in its range, and a rule there.
Svg draw_forest(const Forest& forest);

}  // namespace jnd
