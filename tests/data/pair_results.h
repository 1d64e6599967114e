// Results of pairs: of counts alone, or of a study's estimates without the tests, and what is read of them.
#pragma once

#include <optional>
#include <stdexcept>
#include <vector>

#include "data/results/study_results.h"

namespace jnd {

// Places of the outcomes of pairs at given levels.
inline constexpr std::size_t kSlope = 0, kJnd = 1, kWeber = 2;

inline StudyResults results_of(const std::vector<CellCounts>& cells, const Protocol& protocol,
                               bool hierarchical = false) {
  TaskResults task = results_of_counts(cells, protocol, SessionKind::simulated);
  const std::size_t participants = by_participant(task.estimates, protocol.conditions.size()).size();
  return results_of(std::move(task), static_cast<int>(participants), protocol, hierarchical);
}

// by: the registered differences where it is not given.
inline TaskResults estimates_in(const Study& study, const Protocol& protocol, SessionKind kind = SessionKind::simulated,
                                std::optional<DifferenceSource> by = std::nullopt) {
  const std::vector<SessionInfo> sessions = sessions_of(study, kind);
  const CountedTrials trials(study, protocol, sessions, true);
  return task_results(study, protocol, sessions, trials, by.value_or(registered_source(protocol)));
}

// NaN where there is none.
inline double value_of(const TaskEstimateRow& row, std::size_t outcome) {
  return row.estimates.values.at(outcome).value.value_or(kNaN);
}

inline const TaskGroupRow& group_of(const TaskResults& results, int condition, std::size_t outcome) {
  for (const TaskGroupRow& row : results.group)
    if (row.condition == condition && row.outcome == outcome) return row;
  throw std::out_of_range("no such row of the group");
}

}  // namespace jnd
