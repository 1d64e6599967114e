// The CSV files of `jnd calc compare` and `jnd calc wilcoxon` as tables of numbers.
#pragma once

#include <string>
#include <vector>

#include "analysis/group/mixed_anova.h"
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

// Where participants are in groups: every one has a value under each condition, or one value alone.
struct GroupedLongTable {
  std::vector<std::string> groups, conditions;  // in the order of their first row
  GroupedTable values;                          // k = 1 where every participant has one value alone
  bool mixed() const noexcept { return values.values.k > 1; }
};
// Columns participant, condition (may be missing where everybody has one row), value, group. Throws one located
// InputError where a participant is in two groups or has half a row, there is one group, or a group of participants
// with one value each has several conditions.
GroupedLongTable grouped_table(const CsvTable& csv);

struct PairedColumn {
  std::string item;          // empty without a column of that name
  std::vector<double> x, y;  // of equal size
};
// Columns x, y and perhaps item, in the order of each item's first row.
std::vector<PairedColumn> paired_columns(const CsvTable& csv);

}  // namespace jnd
