#include "runner/calc/csv_counts.h"

#include <fmt/format.h>

namespace jnd {

Counts counts_of(const CsvTable& table, std::size_t row) {
  Counts counts;
  counts.n_diff = table.integer(row, "n_diff", 0);
  counts.hits = table.integer(row, "hits", 0);
  counts.n_same = table.integer(row, "n_same", 0);
  counts.false_alarms = table.integer(row, "false_alarms", 0);
  if (counts.hits > counts.n_diff)
    table.fail(row, "hits", fmt::format("{} hits of {} trials with different stimuli", counts.hits, counts.n_diff),
               "hits are at most n_diff");
  if (counts.false_alarms > counts.n_same)
    table.fail(row, "false_alarms",
               fmt::format("{} false alarms of {} trials with equal stimuli", counts.false_alarms, counts.n_same),
               "false_alarms are at most n_same");
  return counts;
}

}  // namespace jnd
