#include "data/results/study_results.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "data/log/replay.h"
#include "data/results/rating_answers.h"
#include "data/results/study_cautions.h"
#include "data/study/blinding.h"
#include "protocols/course/prescription.h"
#include "protocols/delivery.h"
#include "protocols/planning/allotment.h"

namespace jnd {

namespace {

void add_ratings(StudyResults& results, const Study& study, const Protocol& protocol,
                 const std::vector<SessionInfo>& sessions) {
  const std::vector<std::string> participants = participants_of(sessions);
  std::vector<std::optional<int>> groups;
  for (std::size_t i = 0; i < sessions.size(); ++i)
    if (i == 0 || sessions[i].participant != sessions[i - 1].participant)
      groups.push_back(group_named(protocol, sessions[i].group));
  const std::vector<RatedQuestion> ratings = read_ratings(study, protocol, sessions);
  for (const RatedQuestion& rated : ratings)
    if (rated.paired) results.comparisons.push_back(compare_ratings(rated, participants, protocol, groups));
  results.questionnaire = questionnaire_of(ratings, participants.size(), protocol);
}

// Held of as many people as are shown one by one.
CountedTrials trials_of(const Study& study, const Protocol& protocol, const std::vector<SessionInfo>& sessions) {
  return {study, protocol, sessions, participants_of(sessions).size() <= kMostInDetail};
}

void add_answers(StudyResults& results, const Protocol& protocol, const std::vector<SessionInfo>& sessions,
                 const CountedTrials& trials) {
  if (trials.are_held()) results.answers = answer_raster(protocol, sessions, trials.held());
}

void add_registered(StudyResults& results, OutcomeComparison comparison, const Protocol& protocol) {
  comparison.registered = true;
  if (!protocol.groups.empty()) results.groups = compare_groups(comparison, protocol);
  results.comparisons.push_back(std::move(comparison));
}

void add_cautions(StudyResults& results, const Protocol& protocol) {
  results.deviations = deviations_of(results, protocol);
  results.cautions = cautions_of(results, protocol);
}

// With what follows from the thresholds alone.
ConstantResults constant_results(StudyAnalysis analysis, const Protocol& protocol) {
  ConstantResults results;
  results.analysis = std::move(analysis);
  results.by_series = compare_series(results.analysis.cells, protocol);
  results.detailed = static_cast<std::size_t>(results.analysis.attendance.participants) <= kMostInDetail;
  if (results.detailed) results.sensitivity = study_sensitivity(results.analysis, protocol);
  return results;
}

StudyResults constant_results_of(const Study& study, const Protocol& protocol, SessionKind kind, DifferenceSource by) {
  StudyResults results;
  const std::vector<SessionInfo> sessions = sessions_of(study, kind);
  const CountedTrials trials = trials_of(study, protocol, sessions);
  ConstantResults measured = constant_results(analyze(study, protocol, kind, by, sessions, trials), protocol);
  const std::vector<ThresholdResult>& thresholds = measured.analysis.thresholds;
  add_registered(results, compare_thresholds(thresholds, protocol, protocol.analysis.tests.outcome), protocol);
  results.comparisons.push_back(compare_times(thresholds, protocol));
  add_ratings(results, study, protocol, sessions);
  add_answers(results, protocol, sessions, trials);
  if (measured.detailed) measured.behaviour = study_behaviour(protocol, sessions, trials.held());
  if (measured.detailed) measured.sureness = study_sureness(protocol, sessions, trials.held());
  results.measured = std::move(measured);
  return results;
}

// Thresholds of the procedure's own kind, compared over the conditions like any other outcome.
StudyResults adaptive_results_of(const Study& study, const Protocol& protocol, SessionKind kind) {
  StudyResults results;
  AdaptiveResults measured = adaptive_results(study, protocol, kind);
  add_registered(results, compare_adaptive(measured.rows, protocol), protocol);
  const std::vector<SessionInfo> sessions = sessions_of(study, kind);
  add_ratings(results, study, protocol, sessions);
  const CountedTrials trials = trials_of(study, protocol, sessions);
  add_answers(results, protocol, sessions, trials);
  add_answers(measured, protocol, sessions, trials);
  results.measured = std::move(measured);
  return results;
}

StudyResults exploration_results_of(const Study& study, const Protocol& protocol, SessionKind kind) {
  StudyResults results;
  const std::vector<SessionInfo> sessions = sessions_of(study, kind);
  results.questionnaire =
      questionnaire_of(read_ratings(study, protocol, sessions), participants_of(sessions).size(), protocol);
  results.measured = exploration_results(study, protocol, kind);
  return results;
}

StudyResults task_results_of(const Study& study, const Protocol& protocol, SessionKind kind) {
  StudyResults results;
  const std::vector<SessionInfo> sessions = sessions_of(study, kind);
  const CountedTrials trials = trials_of(study, protocol, sessions);
  MeasuredTask measured{attendance_of(study, kind, sessions), task_results(study, protocol, sessions, trials)};
  add_registered(results, compare_task(measured.task, protocol), protocol);
  add_ratings(results, study, protocol, sessions);
  add_answers(results, protocol, sessions, trials);
  results.measured = std::move(measured);
  return results;
}

StudyResults computed_results_of(const Study& study, const Protocol& protocol, SessionKind kind, DifferenceSource by) {
  if (protocol.task.kind == TaskKind::explore) return exploration_results_of(study, protocol, kind);
  if (!task_of(protocol.task.kind).has_own_results()) return task_results_of(study, protocol, kind);
  if (protocol.design.procedure) return adaptive_results_of(study, protocol, kind);
  return constant_results_of(study, protocol, kind, by);
}

// Of a rig of the laboratory's own, which says itself what it delivered; empty: as asked, or it measures nothing.
std::string delivery_caution(const Study& study, const Protocol& protocol, SessionKind kind) {
  if (protocol.rig.device != kExternalRig || kind == SessionKind::simulated) return {};
  Deliveries all;
  for (const SessionInfo& session : sessions_of(study, kind)) {
    const Deliveries its = deliveries_of(replay(study.events(session.id)).completed, protocol);
    all.measured += its.measured;
    all.off += its.off;
  }
  if (all.off == 0) return {};
  return fmt::format(
      "By its own measure the rig did not deliver what was asked in {} of {} intervals (more than {:.0f} % off): what was "
      "felt there is not what these numbers assume.",
      all.off, all.measured, 100 * kDeliveryTolerance);
}

}  // namespace

namespace {

// Numbers of every kind of session are allotted to the same groups: where people's are sealed, so are all.
struct ForgetGroups {
  void operator()(ConstantResults& measured) const {
    for (CellResult& row : measured.analysis.cells) row.group.reset();
    for (ThresholdResult& row : measured.analysis.thresholds) row.group.reset();
  }
  void operator()(AdaptiveResults& measured) const {
    for (AdaptiveRow& row : measured.rows) row.group.reset();
  }
  void operator()(MeasuredTask& measured) const {
    for (TaskEstimateRow& row : measured.task.estimates) row.group.reset();
    for (TaskCountRow& row : measured.task.counts) row.group.reset();
  }
  void operator()(ExplorationResults&) const {}
};

}  // namespace

const Attendance& attendance_of(const StudyResults& results) {
  struct Found {
    const Attendance& operator()(const ConstantResults& measured) const { return measured.analysis.attendance; }
    const Attendance& operator()(const AdaptiveResults& measured) const { return measured.attendance; }
    const Attendance& operator()(const ExplorationResults& measured) const { return measured.attendance; }
    const Attendance& operator()(const MeasuredTask& measured) const { return measured.attendance; }
  };
  return std::visit(Found{}, results.measured);
}

StudyResults results_of(const Study& study, const Protocol& protocol, SessionKind kind, DifferenceSource by) {
  ChainReport chains = require_whole_chains(study);
  StudyResults results = computed_results_of(study, protocol, kind, by);
  if (judges_exploration(protocol)) {
    for_counted_trials(study, protocol, sessions_of(study, kind),
                       [&](const CountedTrial& trial) { results.off_prescription += trial.off_prescription ? 1 : 0; });
  }
  if (protocol.analysis.hierarchical) add_hierarchical(results, protocol);
  add_cautions(results, protocol);
  if (const std::string words = delivery_caution(study, protocol, kind); !words.empty())
    results.cautions.insert(results.cautions.begin(), words);
  const bool sealed = plan_sealed(study, protocol);
  if (sealed) results.answers.clear();  // trial by trial they are the plan that people are to have
  if (sealed && results.groups && protocol.allotment == Allotment::balanced) {
    std::visit(ForgetGroups{}, results.measured);
    if (results.hierarchical)
      for (HierarchicalPerson& row : results.hierarchical->people) row.group.reset();
  }
  results.chains = std::move(chains);
  return results;
}

StudyResults results_of(const Study& study, const Protocol& protocol, SessionKind kind) {
  return results_of(study, protocol, kind, registered_source(protocol));
}

void add_hierarchical(StudyResults& results, const Protocol& protocol) {
  struct Fitted {
    const Protocol& protocol;
    std::optional<StudyHierarchical> operator()(const ConstantResults& measured) const {
      return study_hierarchical(measured.analysis, protocol);
    }
    std::optional<StudyHierarchical> operator()(const AdaptiveResults& measured) const {
      return study_hierarchical(measured, protocol);
    }
    std::optional<StudyHierarchical> operator()(const MeasuredTask& measured) const {
      if (!task_of(protocol.task.kind).answer_model(protocol)) return std::nullopt;
      return study_hierarchical(measured.task, protocol);
    }
    std::optional<StudyHierarchical> operator()(const ExplorationResults&) const { return std::nullopt; }
  };
  if (!results.hierarchical) results.hierarchical = std::visit(Fitted{protocol}, results.measured);
}

std::vector<ContrastRow> contrasts_of(const StudyResults& results, const Protocol& protocol) {
  if (results.comparisons.empty()) return {};
  const auto* constant = std::get_if<ConstantResults>(&results.measured);
  std::vector<ContrastRow> rows =
      contrast_rows(constant == nullptr ? std::vector<ContrastResult>() : constant->analysis.contrasts,
                    results.comparisons.front(), protocol);
  if (!protocol.analysis.hierarchical || !results.hierarchical) return rows;
  return hierarchical_contrasts(rows, *results.hierarchical, protocol);
}

StudyResults results_of(StudyAnalysis analysis, const Protocol& protocol) {
  StudyResults results;
  add_registered(results, compare_thresholds(analysis.thresholds, protocol, protocol.analysis.tests.outcome), protocol);
  results.measured = constant_results(std::move(analysis), protocol);
  if (protocol.analysis.hierarchical) add_hierarchical(results, protocol);
  add_cautions(results, protocol);
  return results;
}

}  // namespace jnd
