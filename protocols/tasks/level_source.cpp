#include "protocols/tasks/level_source.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "analysis/numerics/decimal_order.h"
#include "protocols/tasks/task.h"

namespace jnd {

bool levels_given(const Protocol& protocol) noexcept {
  return !protocol.design.procedure;
}

std::vector<int> sides_of_comparisons(const Protocol& protocol, const Series& series) {
  if (const auto& procedure = protocol.design.procedure) return procedure->sides;
  std::vector<int> sides;
  for (const double level : series.levels) {
    const int side = level < series.standard ? -1 : level > series.standard ? 1 : 0;
    if (std::find(sides.begin(), sides.end(), side) == sides.end()) sides.push_back(side);
  }
  return sides;
}

std::vector<double> extreme_comparisons(const Protocol& protocol, const Series& series) {
  const auto& procedure = protocol.design.procedure;
  if (!procedure) return series.levels;
  if (procedure->sides.front() == 0) return {procedure->clamp.begin(), procedure->clamp.end()};
  std::vector<double> comparisons;
  for (const int side : procedure->sides) comparisons.push_back(plain_sum(series.standard, side * procedure->clamp[1]));
  return comparisons;
}

double largest_difference(const Protocol& protocol) {
  double largest = 0;
  for (const Series& series : protocol.series) {
    largest = std::max(largest, std::abs(series.pair[1] - series.pair[0]));
    for (const double level : series.levels) largest = std::max(largest, std::abs(level - series.standard));
  }
  const auto& procedure = protocol.design.procedure;
  return procedure ? std::max(largest, procedure->clamp[1]) : largest;
}

double catch_share(const Protocol& protocol) noexcept {
  const auto& procedure = protocol.design.procedure;
  return procedure ? procedure->catch_share : 0;
}

std::string cells_text(const Protocol& protocol) {
  const Task& task = task_of(protocol.task.kind);
  if (levels_given(protocol)) return task.cells_text(protocol);
  const std::string tracks = counted_words(protocol.design.procedure->starts.size(), "track");
  return task.has_pairs() ? tracks : counted_words(protocol.series.size(), "standard") + " x " + tracks;
}

std::string catch_words(const Protocol& protocol) {
  if (levels_given(protocol) || !task_of(protocol.task.kind).has_catch_trials()) return {};
  return fmt::format(", {:.0f} % of them catch trials", 100 * catch_share(protocol));
}

std::string_view level_words(const Protocol& protocol) noexcept {
  return levels_given(protocol) ? "levels of the protocol" : "levels set by the procedure";
}

}  // namespace jnd
