#include "analysis/thresholds/ml_cells.h"

#include <algorithm>
#include <cmath>

#include "analysis/numerics/special_values.h"

namespace jnd {

namespace {

// k log(k/n) + (n - k) log(1 - k/n), with 0 log 0 = 0.
double saturated_cell(const MlCell& cell) noexcept {
  double sum = 0;
  if (cell.said > 0) sum += cell.said * std::log(cell.said / cell.n);
  if (cell.unsaid() > 0) sum += cell.unsaid() * std::log(cell.unsaid() / cell.n);
  return sum;
}

void add_cell(std::vector<MlCell>& cells, double x, int n, int said) {
  const auto at =
      std::lower_bound(cells.begin(), cells.end(), x, [](const MlCell& cell, double x) { return cell.x < x; });
  if (at != cells.end() && at->x == x) {
    at->n += n;
    at->said += said;
    return;
  }
  MlCell cell;
  cell.x = x;
  cell.n = n;
  cell.said = said;
  cells.insert(at, cell);
}

void classify(MlGroup& group) {
  double least_said = kInf, most_said = -kInf, least_unsaid = kInf, most_unsaid = -kInf;
  for (const MlCell& cell : group.cells) {
    if (cell.said > 0) {
      least_said = std::min(least_said, cell.x);
      most_said = std::max(most_said, cell.x);
    }
    if (cell.unsaid() > 0) {
      least_unsaid = std::min(least_unsaid, cell.x);
      most_unsaid = std::max(most_unsaid, cell.x);
    }
    group.saturated += saturated_cell(cell);
  }
  group.all_alike = most_said == -kInf || most_unsaid == -kInf;
  // One difference may have both answers: the criterion then sits there, and every other cell is certain in the limit.
  group.rises = !group.all_alike && most_unsaid <= least_said;
  group.falls = !group.all_alike && most_said <= least_unsaid;
}

}  // namespace

std::vector<MlGroup> ml_groups(std::span<const SeriesCounts> series, bool common) {
  std::vector<MlGroup> groups;
  for (const SeriesCounts& one : series) {
    if (groups.empty() || !common) groups.emplace_back();
    add_cell(groups.back().cells, 0, one.counts.n_same, one.counts.false_alarms);
    add_cell(groups.back().cells, one.difference, one.counts.n_diff, one.counts.hits);
  }
  for (MlGroup& group : groups) classify(group);
  return groups;
}

MlMaximum ml_maximum(std::span<const MlGroup> groups) noexcept {
  bool any = false, all_rise = true, all_fall = true;
  for (const MlGroup& group : groups) {
    if (group.all_alike) continue;
    any = true;
    all_rise = all_rise && group.rises;
    all_fall = all_fall && group.falls;
  }
  if (!any) return MlMaximum::anywhere;
  if (all_rise) return MlMaximum::at_plus_infinity;
  return all_fall ? MlMaximum::at_minus_infinity : MlMaximum::finite;
}

double saturated_log_likelihood(std::span<const MlGroup> groups) noexcept {
  double sum = 0;
  for (const MlGroup& group : groups) sum += group.saturated;
  return sum;
}

}  // namespace jnd
