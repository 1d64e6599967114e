// Small adaptive protocols and their observers.
#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "data/task_results/participant_tracks.h"
#include "data/task_results/task_results.h"
#include "protocols/planning/track_threshold.h"
#include "protocols/tasks/task.h"
#include "tests/runner/engine_fixture.h"

namespace jnd::test {

using nlohmann::json;

inline json staircase_changes() {
  return json::parse(R"({
    "series": null,
    "design": {"trials_per_cell": null, "sampling": null,
      "procedure": {"kind": "staircase", "starts": [500, 100], "clamp": [20, 800], "up": 1, "down": 2, "step_up": 80, "step_down": 80,
                    "halve_after": [1, 2], "averaged_reversals": 4, "stop": {"reversals": 6, "at_most": 24}, "catch_share": 0.5}}
  })");
}
inline Protocol staircase(const json& more = {}) {
  json changes = staircase_changes();
  if (!more.is_null()) changes.merge_patch(more);
  return small_protocol(changes);
}
// Few enough trials to try every place.
inline Protocol short_staircase(const json& more = {}) {
  json changes = {
      {"design", {{"procedure", {{"averaged_reversals", 2}, {"stop", {{"reversals", 3}, {"at_most", 8}}}}}}}};
  if (!more.is_null()) changes.merge_patch(more);
  return staircase(changes);
}
inline Protocol quest(int trials) {
  json changes = staircase_changes();
  changes["design"]["procedure"] = {
      {"kind", "quest"},     {"starts", {300}}, {"clamp", {20, 800}}, {"guess_sd", 0.3}, {"gamma", 0.1},
      {"p_threshold", 0.75}, {"range", 3},      {"delta", 0.01},      {"beta", 2},       {"stop", {{"trials", trials}}},
      {"catch_share", 0.25}};
  return small_protocol(changes);
}
inline Protocol posterior(const json& stop) {
  json changes = staircase_changes();
  changes["design"]["procedure"] = {
      {"kind", "posterior"}, {"levels", {{"from", 25}, {"to", 600}, {"step", 25}}}, {"stop", stop}};
  return small_protocol(changes);
}
// A staircase whose threshold is that of all answers.
inline Protocol joint_staircase(int trials) {
  json changes = staircase_changes();
  changes["design"]["procedure"] = {{"kind", "staircase"},
                                    {"starts", {500}},
                                    {"clamp", {20, 800}},
                                    {"up", 1},
                                    {"down", 1},
                                    {"step_up", 180},
                                    {"step_down", 20},
                                    {"halve_after", {1}},
                                    {"threshold", "joint-likelihood"},
                                    {"stop", {{"trials", trials}}},
                                    {"catch_share", 0.25}};
  return small_protocol(changes);
}

// Says "different" from this difference on.
inline std::function<std::optional<int>(const TrialQuestion&)> sharp(double threshold) {
  return [threshold](const TrialQuestion& question) {
    const double one = question.trial.stimuli[0], two = question.trial.stimuli[1];
    return std::optional(std::abs(one - two) >= threshold ? kClassDifferent : kClassSame);
  };
}

// By condition, then track.
inline std::vector<AdaptiveTrack> tracks_of(const Bench& bench) {
  return participant_tracks({bench.log.events()}, bench.protocol, "P01", std::nullopt);
}

// Adds the estimates of who answered on the bench, as a study's results have them.
inline void add_observer(TaskResults& results, const Bench& bench) {
  const std::vector<AdaptiveTrack> tracks = tracks_of(bench);
  for (int condition = 0; condition < static_cast<int>(bench.protocol.conditions.size()); ++condition) {
    TaskEstimateRow row;
    row.condition = condition;
    std::vector<AdaptiveTrack> own;
    for (const AdaptiveTrack& track : tracks) {
      if (track.condition != condition) continue;
      own.push_back(track);
      row.trials += static_cast<int>(track.levels.size());
      row.catch_trials += track.catch_trials;
      row.false_alarms += track.false_alarms;
    }
    row.estimates = measured_estimates(bench.protocol, bench.protocol.series.front(), {}, own);
    results.estimates.push_back(std::move(row));
  }
}

}  // namespace jnd::test
