// How well a design measures the outcomes of its task: many participants who feel alike go through its plan by the task's
// own response model, and their estimates are compared. For every task that has trials but same-different with fixed series,
// whose precision is computed (planned_precision.h).
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "protocols/protocol.h"

namespace jnd {

struct TaskPrecisionQuestion {
  int participants = 400;  // simulated, 2..100000
  std::uint64_t seed = 1;
  // Standard deviation of the felt difference of two intervals, in the study's unit; Task::jnd_of_noise says how large a JND
  // that is. None: kAssumedWeber of the standard,
  // or where there is none of the middle of the levels.
  std::optional<double> noise{};
};
inline constexpr double kAssumedWeber = 0.2;

// One outcome of one standard. Numbers are NaN where fewer than two participants have an estimate.
struct TaskPrecisionRow {
  int series = 0;                        // place in Protocol::series
  std::size_t outcome = 0;               // place in Task::outcomes
  double noise = 0;                      // as in the question, of this series
  double trials = 0;                     // of a participant, mean: a procedure's tracks end where the answers end them
  double median = 0, low = 0, high = 0;  // of the participants' estimates: the middle, and the middle 95 % of them
  double cv = 0;                         // SD / |mean| of the estimates
  double undefined = 0;                  // share of participants without a finite estimate
};

// protocol: of a task with outcomes. progress: participants so far, on the calling thread; may be empty.
std::vector<TaskPrecisionRow> task_precision(const Protocol& protocol, const TaskPrecisionQuestion& question,
                                             const std::function<void(int)>& progress = {});

}  // namespace jnd
