#include "data/task_results/study_sureness.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace jnd {
namespace {

// Of an answer among the ordered categories, from "same" with the greatest sureness to "different" with it.
std::size_t category_of(const CountedTrial& trial, int degrees) {
  const int sureness = std::clamp(trial.sureness, 1, degrees);
  return static_cast<std::size_t>(trial.said_different() ? degrees + sureness - 1 : degrees - sureness);
}

}  // namespace

std::vector<SurenessRow> study_sureness(const Protocol& protocol, const std::vector<SessionInfo>& sessions,
                                        const std::vector<CountedTrial>& trials) {
  const int degrees = protocol.task.sureness_levels;
  if (degrees == 0) return {};
  using Levels = std::map<double, std::vector<int>>;
  std::map<std::pair<std::string, int>, Levels> cells;
  for (const CountedTrial& trial : trials) {
    if (!exclusion_reason(protocol.analysis.exclude, trial).empty()) continue;
    const std::string& participant = sessions[static_cast<std::size_t>(trial.session)].participant;
    const double delta = trial.same() ? 0 : std::abs(trial.asked[0] - trial.asked[1]);
    std::vector<int>& counts = cells[{participant, trial.condition}][delta];
    counts.resize(2 * static_cast<std::size_t>(degrees));
    ++counts[category_of(trial, degrees)];
  }
  std::vector<SurenessRow> rows;
  for (const auto& [place, of] : cells) {
    SurenessRow row{place.first, place.second, 0, {}};
    std::vector<SurenessLevel> levels;
    for (const auto& [delta, counts] : of) {
      levels.push_back({delta, counts});
      for (const int count : counts) row.trials += count;
    }
    row.fit = sureness(levels);
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace jnd
