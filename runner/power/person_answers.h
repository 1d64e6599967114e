// What the answers of one simulated participant leave for the analyses, wherever the answers come from: drawn from the
// response model, or given by a participant in the simulated rig.
#pragma once

#include <optional>
#include <vector>

#include "analysis/hierarchical/hierarchical_likelihood.h"
#include "data/task_results/task_results.h"
#include "protocols/planning/adaptive_run.h"
#include "protocols/protocol.h"
#include "protocols/tasks/task.h"

namespace jnd {

// What one participant leaves.
struct DrawnPerson {
  std::optional<int> group{};              // place in Protocol::groups
  std::vector<HierarchicalCell> answers;   // by condition and level; participant 0
  std::vector<TaskEstimateRow> estimates;  // by condition and standard
  bool dropped = false;                    // out: nothing of it counts
};

// An answer that counts.
struct PersonAnswer {
  int condition = 0, series = 0;  // places in the protocol
  AnsweredTrial trial;
};

// Of all sessions of a participant.
struct PersonAnswers {
  std::vector<PersonAnswer> given;    // in their order
  std::vector<AdaptiveTrack> tracks;  // of a procedure; all sessions
};

// person: with its group. participant: from 1. protocol: of a task with a response model.
void add_measured(DrawnPerson& person, int participant, const PersonAnswers& answers, const Protocol& protocol);

// The parts of it, for who has counts instead of answers. Cells of equal levels are added up.
void add_answers(std::vector<HierarchicalCell>& cells, std::size_t condition, double level, int positive, int negative);
void add_threshold(DrawnPerson& person, int participant, std::size_t condition, const std::vector<SeriesCounts>& series,
                   const Protocol& protocol, const ThresholdMethod& method);

}  // namespace jnd
