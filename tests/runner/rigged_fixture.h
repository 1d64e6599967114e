// Short studies for the simulated rig, for the tests that simulate many.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "protocols/reading/protocol_json.h"
#include "runner/commands/starting_protocol.h"

namespace jnd::testing {

// Force alone and vibration alone, short presses.
inline Protocol of_task(TaskKind task, const std::string& procedure, const nlohmann::json& more = {}) {
  StartingPoint point;
  point.task = task;
  point.procedure = procedure;
  nlohmann::ordered_json json = starting_protocol(point);
  json.merge_patch(nlohmann::ordered_json::parse(R"({
    "trial": {"explore_s": 0.5}, "practice": null,
    "conditions": [{"name": "S", "label": "S", "cues": ["force"]}, {"name": "V", "label": "V", "cues": ["vibration"]}],
    "analysis": {"contrasts": [["S", "V"]]}})"));
  if (!more.is_null()) json.merge_patch(nlohmann::ordered_json(more));
  return parse_protocol(json.dump(), "rigged.json");
}

inline Protocol few_trials(TaskKind task, int trials) {
  return of_task(task, "constant", {{"design", {{"trials_per_cell", trials}}}});
}

inline Protocol short_staircases(TaskKind task) {
  return of_task(task, "staircase", {{"design", {{"procedure", {{"stop", {{"trials", 8}}}}}}}});
}

}  // namespace jnd::testing
