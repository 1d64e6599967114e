// Everything that a study says, by its registered plan and beside it: what `analyze` prints, `export` writes and
// `report` draws. Computed once, from the log alone.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "data/raw_trials/answer_raster.h"
#include "data/results/adaptive_results.h"
#include "data/results/questionnaire_results.h"
#include "data/results/study_analysis.h"
#include "data/results/study_behaviour.h"
#include "data/results/study_comparisons.h"
#include "data/results/study_contrasts.h"
#include "data/results/study_hierarchical.h"
#include "data/results/study_sensitivity.h"
#include "data/task_results/study_sureness.h"
#include "data/task_results/task_results.h"
#include "data/verify/chain_check.h"
#include "protocols/protocol.h"

namespace jnd {

// Where the protocol sets the levels.
struct ConstantResults {
  StudyAnalysis analysis;                   // cells, thresholds, group, contrasts
  SeriesComparison by_series;               // condition x series
  bool detailed = true;                     // what follows was computed; not above kMostInDetail participants
  std::vector<SensitivityRow> sensitivity;  // the registered method first
  StudyBehaviour behaviour;                 // order effect, bias, drift, cue strategy
  std::vector<SurenessRow> sureness;        // the JND from all degrees; empty where sureness is not asked
};

// Of the tasks whose estimates are the task's own.
struct MeasuredTask {
  Attendance attendance;
  TaskResults task;
};

struct StudyResults {
  ChainReport chains;  // of the whole study, read before anything was computed; empty where counts alone were given
  // What was measured: of same-different JNDs over given levels, thresholds where the answers set the levels, or free interaction; of the other tasks the
  // task's own outcomes.
  std::variant<ConstantResults, AdaptiveResults, ExplorationResults, MeasuredTask> measured;
  std::optional<StudyHierarchical> hierarchical{};  // after add_hierarchical(), or where it is registered
  std::vector<OutcomeComparison> comparisons;       // the registered one first, then times, then ratings; none of free
                                                    // interaction
  std::optional<GroupsCompared> groups;             // of participants; none where the protocol has none
  QuestionnaireResults questionnaire;               // what was answered to questions
  std::vector<AnswersOf> answers;       // by participant; not above kMostInDetail of them, nor of counts alone
  int off_prescription = 0;             // answered trials that broke a limit of the prescription
  std::vector<std::string> deviations;  // from what was registered
  std::vector<std::string> cautions;    // where the design cannot carry the number
};

const Attendance& attendance_of(const StudyResults& results);

// Checks the chains of the study first: throws BrokenChain where it is not what was recorded.
StudyResults results_of(const Study& study, const Protocol& protocol, SessionKind kind, DifferenceSource by);
StudyResults results_of(const Study& study, const Protocol& protocol, SessionKind kind);  // by what is registered
// For those who show it: the hierarchical model, of a task whose answers have one. Nothing else waits for its fit.
void add_hierarchical(StudyResults& results, const Protocol& protocol);
// The rows of contrasts.csv and its like; empty where none is registered, or there are no trials.
std::vector<ContrastRow> contrasts_of(const StudyResults& results, const Protocol& protocol);
// Of counts alone: without behaviour, ratings and times.
StudyResults results_of(StudyAnalysis analysis, const Protocol& protocol);

}  // namespace jnd
