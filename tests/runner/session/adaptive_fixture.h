// Small adaptive protocols and their observers.
#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <vector>

#include <nlohmann/json.hpp>

#include "data/results/adaptive_results.h"
#include "protocols/tasks/same_different_task.h"
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

inline std::vector<AdaptiveRow> rows_of(const Bench& bench) {
  return adaptive_rows(bench.log.events(), bench.protocol, "P01", SessionKind::simulated);
}

}  // namespace jnd::test
