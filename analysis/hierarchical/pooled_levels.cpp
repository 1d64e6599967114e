#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "analysis/hierarchical/hierarchical_likelihood.h"

namespace jnd {

namespace {

// The number of the levels that are one with this one.
int neighbours_of(double level, double largest) noexcept {
  constexpr double kShare = 0.05, kSmall = 0.1, kStep = 0.01;
  if (level == 0) return 0;
  const double share = std::abs(level) / largest;
  const double number = share < kSmall ? share / kStep : kSmall / kStep + std::log(share / kSmall) / kShare;
  return static_cast<int>(std::copysign(std::floor(number) + 1, level));
}

}  // namespace

bool pool_levels(std::vector<HierarchicalCell>& cells) {
  std::map<int, std::set<double>> levels;  // by condition
  double largest = 0;
  for (const HierarchicalCell& cell : cells) {
    levels[cell.condition].insert(cell.level);
    largest = std::max(largest, std::abs(cell.level));
  }
  if (std::all_of(levels.begin(), levels.end(), [](const auto& of) { return of.second.size() <= kMostLevels; }))
    return false;
  struct Bin {
    double sum = 0, trials = 0;
  };
  std::map<int, Bin> bins;
  for (const HierarchicalCell& cell : cells) {
    Bin& bin = bins[neighbours_of(cell.level, largest)];
    bin.sum += cell.counts().trials() * cell.level;
    bin.trials += cell.counts().trials();
  }
  std::map<std::tuple<int, int, double, bool>, HierarchicalCell> pooled;
  for (const HierarchicalCell& cell : cells) {
    const Bin& bin = bins[neighbours_of(cell.level, largest)];
    const double level = bin.trials > 0 ? bin.sum / bin.trials : cell.level;
    const auto [place, added] = pooled.try_emplace({cell.participant, cell.condition, level, cell.second_half}, cell);
    place->second.level = level;
    if (added) continue;
    place->second.positive += cell.positive;
    place->second.negative += cell.negative;
    place->second.sure_positive += cell.sure_positive;
    place->second.sure_negative += cell.sure_negative;
  }
  cells.clear();
  for (const auto& [where, cell] : pooled) cells.push_back(cell);
  return true;
}

}  // namespace jnd
