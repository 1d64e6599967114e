// What the answers to a task measure: counts, the task's own estimates of every participant, condition and standard,
// and the group. Which numbers there are says the task (Task::outcomes); this is the same for all of them.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/group/group.h"
#include "data/study/study.h"
#include "data/study/trial_rows.h"
#include "protocols/protocol.h"
#include "protocols/tasks/task.h"

namespace jnd {

// How often one answer was given to one arrangement of stimuli; of answers with numbers one row for each number.
struct TaskCountRow {
  std::string participant;
  SessionKind kind = SessionKind::simulated;
  int condition = 0, series = 0;  // places in the protocol
  Intervals stimuli;
  int target = -1, said = -1, sureness = 0;
  std::optional<double> number{};
  int n = 0;
  std::optional<int> group{};  // of the participant, place in Protocol::groups
};

// One participant, condition and series.
struct TaskEstimateRow {
  std::string participant;
  SessionKind kind = SessionKind::simulated;
  int condition = 0, series = 0;
  int trials = 0;    // counted
  int excluded = 0;  // by the registered rules
  int missing = 0;   // planned, without an answer
  TaskEstimates estimates;
  std::optional<double> median_response_time_s{};  // participant's own entries
  std::optional<double> mean_trial_s{};
  std::optional<int> group{};         // of the participant, place in Protocol::groups
  std::vector<LevelCount> answers{};  // for one model of everybody's; empty where the task has none
};

// One outcome in one condition and series, over the participants who have it.
struct TaskGroupRow {
  int condition = 0, series = 0;
  std::size_t outcome = 0;  // place in TaskResults::outcomes
  int participants = 0;     // who get the condition
  MeanEstimate mean;        // with Student's 95 % interval; of those who have a value
  double median = 0;        // NaN without one
};

// Whether the outcome grows in proportion to the standard: Weber's law for a JND. Of each participant the slope of its
// logarithm on that of the standard, least squares; 1 is proportional. Of a Weber fraction that of its JND.
struct ProportionRow {
  int condition = 0;
  MeanEstimate exponent;
  double p = 0;  // of an exponent of 1, Student's t over participants; NaN where there is none
};

// The share of an answer over the levels, all participants of a condition and series together.
struct TaskCurveRow {
  int condition = 0, series = 0;
  TaskCurve curve;
};

struct TaskResults {
  std::vector<TaskOutcome> outcomes;
  std::size_t registered = 0;  // place of the outcome that the protocol compares
  std::vector<TaskCountRow> counts;
  std::vector<TaskEstimateRow> estimates;  // by participant, condition that they get, series
  std::vector<TaskGroupRow> group;         // by condition, series, outcome
  std::vector<ProportionRow> proportion;   // by condition; empty with fewer than two standards
  std::vector<TaskCurveRow> curves;
  std::map<std::string, int> exclusions;  // reason -> trials
};

// As tasks read it.
AnsweredTrial answered(const CountedTrial& trial);

// sessions: of one kind, by participant; trials: of these. Throws StorageError where an event contradicts the protocol.
TaskResults task_results(const Study& study, const Protocol& protocol, const std::vector<SessionInfo>& sessions,
                         const CountedTrials& trials);

// All series of one participant and condition. first: the first of them, in results.estimates.
std::span<const TaskEstimateRow> series_from(const TaskEstimateRow& first, const Protocol& protocol) noexcept;
// An outcome, by its place in Task::outcomes, of one participant and condition: its mean over the series, or that of its
// logarithms. NaN where a series has none.
double outcome_value(const TaskEstimateRow& first, std::size_t outcome, const Protocol& protocol,
                     bool logarithms = false);
// The same of the registered one, of logarithms where the tests are on them.
double registered_value(const TaskEstimateRow& first, const TaskResults& results, const Protocol& protocol);

}  // namespace jnd
