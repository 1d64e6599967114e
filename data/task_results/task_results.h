// What the answers to a task measure: counts, every participant's estimates in each condition and at each standard, the
// tracks of a procedure, and the group. Which numbers there are says the task (Task::outcomes); this is the same for all
// of them.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/group/group.h"
#include "analysis/numerics/special_values.h"
#include "data/study/study.h"
#include "data/study/trial_rows.h"
#include "data/task_results/pair_cells.h"
#include "protocols/planning/adaptive_run.h"
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

// One participant and condition at one standard.
struct TaskEstimateRow {
  std::string participant;
  SessionKind kind = SessionKind::simulated;
  int condition = 0, standard = 0;  // places in Protocol::conditions and judged_standards()
  int trials = 0;                   // counted
  int excluded = 0;                 // by the registered rules
  int missing = 0;                  // planned, without an answer
  TaskEstimates estimates;
  std::optional<double> median_response_time_s{};  // participant's own entries
  std::optional<double> mean_trial_s{};
  std::optional<int> group{};              // of the participant, place in Protocol::groups
  std::vector<LevelCount> answers{};       // for one model of everybody's; empty where the task has none
  int catch_trials = 0, false_alarms = 0;  // of a procedure's tracks, answered
  DifferenceSource difference_source = DifferenceSource::nominal;  // of pairs: of the series in the fit
};

// One track of a procedure, or all of a participant and condition at one standard together.
struct TrackRow {
  std::string participant;
  SessionKind kind = SessionKind::simulated;
  std::optional<int> group{};
  int condition = 0, standard = 0;
  int track = 0;          // from 1; 0: all of them
  bool finished = false;  // the stopping rule was met; of all tracks
  int trials = 0;         // answered, whose level the answers had set
  int hits = 0;           // of these, answered rightly: "different" said, or the comparison where it has more
  int catch_trials = 0, false_alarms = 0;        // answered; of these, wrongly
  std::optional<AdaptiveThreshold> threshold{};  // none where the answers of a condition have one together alone
  std::vector<double> levels{}, reversals{};     // of a track: presented, in order; levels of a staircase's reversals
  std::vector<TrackPosterior> course{};          // of the Bayesian procedure: after each of `levels`
};

// One outcome in one condition and at one standard, over the participants who have it.
struct TaskGroupRow {
  int condition = 0, standard = 0;
  std::size_t outcome = 0;                     // place in TaskResults::outcomes
  int participants = 0;                        // who get the condition
  MeanEstimate mean;                           // with Student's 95 % interval; of those who have a value
  MeanEstimate logarithms = mean_with_ci({});  // of the same, of an outcome that is positive
  double inverse_mean = kNaN;                  // 1 / mean, of slopes: the JND of the mean slope; NaN unless above 1e-9
  // For comparing conditions, after Cousineau 2005 and Morey 2008, of those who have a value under every condition.
  int within_n = 0;
  double within_low = kNaN, within_high = kNaN;
  // Who has none because it lies above or below every value counts there; `middle` says which stands in the middle.
  double median = kNaN;  // NaN unless `middle` is a value, and inf above
  int median_n = 0;
  Beyond middle = Beyond::no;
  std::map<std::string, int> without;  // those without a value, by status
  double false_alarm_rate = kNaN;      // of a procedure with catch trials: mean over those who have a value
  DifferenceSource difference_source = DifferenceSource::nominal;
};

// Whether the outcome grows in proportion to the standard: Weber's law for a JND. Of each participant the slope of its
// logarithm on that of the standard, least squares; 1 is proportional. Of a Weber fraction that of its JND.
struct ProportionRow {
  int condition = 0;
  MeanEstimate exponent;
  double p = 0;  // of an exponent of 1, Student's t over participants; NaN where there is none
};

// The share of an answer over the levels, all participants of a condition and standard together.
struct TaskCurveRow {
  int condition = 0, standard = 0;
  TaskCurve curve;
};

struct TaskResults {
  std::vector<TaskOutcome> outcomes;  // empty of free interaction, which has no trials
  std::size_t registered = 0;         // place of the outcome that the protocol compares
  bool logarithm = false;             // of which the logarithm is compared
  std::vector<TaskCountRow> counts;
  std::vector<CellResult> cells;           // of pairs at given levels: by participant, condition that they get, series
  std::vector<TrackRow> tracks;            // by participant, condition, standard; those of each, then all of them
  std::vector<TaskEstimateRow> estimates;  // by participant, condition that they get, standard
  std::vector<TaskGroupRow> group;         // by condition, standard, outcome
  std::vector<ProportionRow> proportion;   // by condition; empty with fewer than two standards
  std::vector<TaskCurveRow> curves;
  std::map<std::string, int> exclusions;  // reason -> trials
  PairMethod pairs;                       // of pairs at given levels: what is behind every slope and JND
};

// Whether the tracks of its procedure have thresholds; those of the Bayesian procedure have none where the task measures by
// all answers of a condition together.
bool tracks_have_thresholds(const Protocol& protocol);

// Why an outcome has no finite value.
std::string reason_without(const TaskEstimates& estimates, std::size_t outcome);

// As tasks read it.
AnsweredTrial answered(const CountedTrial& trial);

// What the protocol measures and compares, without any data.
TaskResults empty_task_results(const Protocol& protocol);
// sessions: of one kind, by participant; trials: of these; by: nominal or delivered, of pairs at given levels. Throws
// StorageError where an event contradicts the protocol.
TaskResults task_results(const Study& study, const Protocol& protocol, const std::vector<SessionInfo>& sessions,
                         const CountedTrials& trials, DifferenceSource by);
// Of all rows of results.estimates: the group, and what it is of the standard.
void add_group(TaskResults& results, const Protocol& protocol);

// All standards of one participant and condition, and those that are compared: all, or the registered one. first: the first
// of all, in results.estimates.
std::span<const TaskEstimateRow> standards_from(const TaskEstimateRow& first, const Protocol& protocol) noexcept;
std::span<const TaskEstimateRow> compared_standards(const TaskEstimateRow& first, const Protocol& protocol) noexcept;
// An outcome, by its place, of one participant and condition: its mean over these standards, or that of its logarithms. NaN
// where one has none.
double outcome_value(const TaskEstimateRow& first, std::size_t outcome, const Protocol& protocol,
                     bool logarithms = false);
// The same of the registered one, of logarithms where the tests are on them.
double registered_value(const TaskEstimateRow& first, const TaskResults& results, const Protocol& protocol);

// Estimates by participant: where groups of participants get different conditions, nobody has one of them all.
struct ParticipantRows {
  std::string participant;
  std::optional<int> group;                // place in Protocol::groups
  std::vector<const TaskEstimateRow*> of;  // by condition, at the first standard; null where the group does not get it
};
// rows: those of a participant together; they must outlive the result.
std::vector<ParticipantRows> by_participant(const std::vector<TaskEstimateRow>& rows, std::size_t conditions);

}  // namespace jnd
