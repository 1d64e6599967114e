// A protocol's design as a question about its precision (analysis/precision/precision.h): what JNDs are to be expected,
// and what the participants' counts will be drawn from.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/precision/precision.h"
#include "protocols/protocol.h"

namespace jnd {

// Where a true JND for planning comes from.
enum class JndSource {
  published,  // the protocol's published value of the condition
  assumed,    // no value is published: the Weber fraction of the condition's cues
  asked       // given by the user
};
std::string_view to_string(JndSource source) noexcept;

struct PlannedJnd {
  double value = 0;  // > 0, in the study's unit
  JndSource source = JndSource::assumed;
};
// Without a published value: that of the shipped simulated participants (devices/profiles), 31.5 % of the reference
// with force and 39 % with vibration (Chinello et al. 2017, conditions S and V), 23 % at a joint (Jones and Hunter
// 1990, Exp. Brain Res. 79, 150-156), and of several cues together 1 / sqrt(sum of 1 / w^2).
PlannedJnd planned_jnd(const Protocol& protocol, std::string_view condition);

// Is it a design whose precision can be foretold: same-different trials with a number of trials fixed for each series?
bool has_precision(const Protocol& protocol) noexcept;

// The following are for such protocols.
CountsDesign counts_design(const Protocol& protocol);

// Conditions in the protocol's order with their planned JNDs, its contrasts (without any: every pair), its
// participants; where groups get different conditions, pairs that somebody has, and the participants of one group. Where
// conditions x series x participants is above 500, fewer than 20,000 studies are drawn, but at
// least 1,000: 10 million draws of a participant's answers to one series in all.
PrecisionQuestion precision_question(const Protocol& protocol);

// What the figures of analysis/precision/precision.h do not cover of this protocol's registered analysis; empty where
// they are for that very analysis.
std::string precision_note(const Protocol& protocol);

// How well a design measures the outcomes of its task: many participants who feel alike go through its plan by the task's
// own response model, and their estimates are compared. For every task that has trials but same-different with fixed series,
// whose precision is computed (as above).
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
