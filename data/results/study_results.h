// Everything that a study says, by its registered plan and beside it: what `analyze` prints, `export` writes and
// `report` draws. Computed once, from the log alone; the same for every task and whatever sets its levels: what a study
// has not is empty.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "data/raw_trials/answer_raster.h"
#include "data/results/attendance.h"
#include "data/results/cue_combination.h"
#include "data/results/questionnaire_results.h"
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

struct StudyResults {
  ChainReport chains;  // of the whole study, read before anything was computed; empty where counts alone were given
  Attendance attendance;
  bool detailed = true;  // what takes a look at each participant was computed; not above kMostInDetail of them
  TaskResults task;      // empty of free interaction
  // Of pairs at given levels.
  SeriesComparison by_series;               // condition x series
  std::vector<SensitivityRow> sensitivity;  // the registered method first
  StudyBehaviour behaviour;                 // order effect, bias, drift, cue strategy
  std::vector<SurenessRow> sureness;        // the JND from all degrees; empty where sureness is not asked
  std::vector<CueCombination> combinations;
  std::optional<StudyHierarchical> hierarchical{};  // where it was asked for or registered, of a task that has one
  std::vector<OutcomeComparison> comparisons;       // the registered one first, then times, then ratings
  std::vector<ContrastRow> contrasts;               // registered
  std::optional<GroupsCompared> groups;             // of participants; none where the protocol has none
  QuestionnaireResults questionnaire;               // what was answered to questions
  ExplorationResults exploration;                   // choices; how long was explored
  std::vector<AnswersOf> answers;       // by participant; not above kMostInDetail of them, nor of counts alone
  int off_prescription = 0;             // answered trials that broke a limit of the prescription
  std::vector<std::string> deviations;  // from what was registered
  std::vector<std::string> cautions;    // where the design cannot carry the number

  // That of the registered outcome; null without trials.
  const OutcomeComparison* registered() const noexcept {
    return !comparisons.empty() && comparisons.front().registered ? &comparisons.front() : nullptr;
  }
};

// What is computed only where it is asked for.
struct ResultsAsked {
  DifferenceSource by = DifferenceSource::nominal;  // nominal or delivered, of pairs at given levels
  bool hierarchical = false;                        // the model, also where it is not registered: its fit takes time
};

// Checks the chains of the study first: throws BrokenChain where it is not what was recorded.
StudyResults results_of(const Study& study, const Protocol& protocol, SessionKind kind, const ResultsAsked& asked);
// By what is registered.
StudyResults results_of(const Study& study, const Protocol& protocol, SessionKind kind);
// Of counts alone: without behaviour, ratings and times.
StudyResults results_of(TaskResults task, int participants, const Protocol& protocol, bool hierarchical = false);

}  // namespace jnd
