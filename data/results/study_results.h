// Everything that a study says, by its registered plan and beside it: what `analyze` prints, `export` writes and
// `report` draws. Computed once, from the log alone; the same for every task and whatever sets its levels: what a study
// has not is empty.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/behaviour/cue_strategy.h"
#include "analysis/behaviour/trial_effects.h"
#include "analysis/numerics/special_values.h"
#include "analysis/ratings/sureness.h"
#include "data/raw_trials/answer_raster.h"
#include "data/results/attendance.h"
#include "data/results/cue_combination.h"
#include "data/results/questionnaire_results.h"
#include "data/results/study_comparisons.h"
#include "data/results/study_contrasts.h"
#include "data/results/study_hierarchical.h"
#include "data/study/study.h"
#include "data/study/trial_rows.h"
#include "data/task_results/task_results.h"
#include "data/verify/chain_check.h"
#include "protocols/protocol.h"

namespace jnd {

// The JND of a participant and condition from all degrees of sureness of all answers in one model.
struct SurenessRow {
  std::string participant;
  int condition = 0;  // place in the protocol
  int trials = 0;
  Sureness fit;
};

// Would the conclusion change under another model, method or correction? The registered tests under one of them.
struct SensitivityRow {
  ThresholdMethod method;
  bool registered = false;
  std::vector<TaskGroupRow> group;     // of the JND, by condition
  int n = 0;                           // participants in the tests
  int participants = 0;                // of all
  double omnibus_p = 0;                // NaN where there is none
  std::vector<double> contrast_p;      // by registered contrast, adjusted as registered; NaN where there is none
  std::vector<double> contrast_slope;  // mean paired difference of the slopes, a - b
  std::string refused;                 // why there are no tests; empty where there are
  // Every registered test decides as in the registered row: on the same side of alpha and, where significant, with the
  // same sign. False where either was refused.
  bool same_conclusion = false;
};

// Holm's p of each test over the rows of one kind: the conditions, or the participants. NaN where there is no test.
struct BehaviourHolm {
  double order = kNaN, bias = kNaN, drift = kNaN, session = kNaN;
};

struct BehaviourRow {
  std::string participant;  // empty: all together
  int condition = -1;       // place in the protocol; -1: all together
  OrderEffect order;
  ResponseBias bias;
  // d' in the second half of each cell's trials against the first: what is learnt or forgotten within a block. Halves
  // of the session would compare different series and conditions wherever those come in blocks.
  Drift drift;
  // Of everyone together, where the orders differ between participants: the second half of the session against the
  // first, each series held against itself. Empty in a participant's row.
  std::optional<StratifiedDrift> session_drift;
  BehaviourHolm holm;
};

struct CueRow {
  int condition = 0;
  CueStrategy strategy;  // over the trials of all participants
  // Participants by the cue that explains their own answers best: as many entries as cues, in the order of Cue.
  std::vector<int> best_of;
  int undecided = 0;  // participants for whom there was none
};

// Does the order of the intervals matter, does a participant lean towards one answer, does performance drift over the
// session, and which of a stimulus's traces explains the answers? Counted trials only.
struct StudyBehaviour {
  std::vector<BehaviourRow> conditions;    // everyone together, by condition
  std::vector<BehaviourRow> participants;  // everything of one participant, by participant
  std::vector<CueRow> cues;                // by condition
};

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
