// The counts of a cell in a CSV file of counts.
#pragma once

#include <cstddef>

#include "analysis/detection/counts.h"
#include "protocols/input/csv_table.h"

namespace jnd {

// Columns n_diff, hits, n_same, false_alarms of one row. Throws InputError, located, where a count is not a whole
// number of 0 or more, or more answers were counted than trials.
Counts counts_of(const CsvTable& table, std::size_t row);

}  // namespace jnd
