// The CSV files of `jnd calc compare` and `jnd calc wilcoxon` as tables of numbers.
#pragma once

#include <string>
#include <vector>

#include "analysis/group/within_table.h"
#include "protocols/input/csv_table.h"

namespace jnd {

// Squares and their sums stay far from the limits of double.
inline constexpr NumberRange kGroupValues{-1e100, 1e100};

struct LongTable {
  std::vector<std::string> participants, conditions;  // in the order of their first row
  WithinTable values;
};
// Columns participant, condition, value. Throws one located InputError where a participant has no value, or two, under
// a condition: tests within participants have no use for half a row, and dropping a participant is the user's decision.
LongTable long_table(const CsvTable& csv);

struct PairedColumn {
  std::string item;          // empty without a column of that name
  std::vector<double> x, y;  // of equal size
};
// Columns x, y and perhaps item, in the order of each item's first row.
std::vector<PairedColumn> paired_columns(const CsvTable& csv);

}  // namespace jnd
