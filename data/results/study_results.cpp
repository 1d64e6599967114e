#include "data/results/study_results.h"

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

// What follows from the estimates alone.
void add_tests(StudyResults& results, const Protocol& protocol, bool times) {
  const TaskResults& task = results.task;
  if (task.outcomes.empty()) return;
  OutcomeComparison registered = compare_task(task, protocol);
  registered.registered = true;
  if (!protocol.groups.empty()) results.groups = compare_groups(registered, protocol);
  results.comparisons.push_back(std::move(registered));
  if (times) results.comparisons.push_back(compare_times(task, protocol));
  results.detailed = static_cast<std::size_t>(results.attendance.participants) <= kMostInDetail;
  if (task.cells.empty()) return;
  results.by_series = compare_series(task.cells, protocol);
  if (results.detailed) results.sensitivity = study_sensitivity(task, protocol);
  if (results.detailed) results.combinations = cue_combinations(task, protocol);
}

void add_model_and_contrasts(StudyResults& results, const Protocol& protocol, bool hierarchical) {
  const OutcomeComparison* const registered = results.registered();
  if (registered == nullptr) return;
  if ((hierarchical || protocol.analysis.hierarchical) &&
      (!results.task.cells.empty() || task_of(protocol.task.kind).answer_model(protocol)))
    results.hierarchical = study_hierarchical(results.task, protocol);
  results.contrasts =
      contrast_rows(results.task, *registered, results.hierarchical ? &*results.hierarchical : nullptr, protocol);
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

// Numbers of every kind of session are allotted to the same groups: where people's are sealed, so are all. Of few
// participants the numbers of a group tell who is in it.
void forget_groups(StudyResults& results) {
  results.groups.reset();
  const auto forget = [](auto& rows) {
    for (auto& row : rows) row.group.reset();
  };
  forget(results.task.cells);
  forget(results.task.counts);
  forget(results.task.estimates);
  forget(results.task.tracks);
  for (OutcomeComparison& outcome : results.comparisons) forget(outcome.everyone);
  if (results.hierarchical) forget(results.hierarchical->people);
}

}  // namespace

StudyResults results_of(const Study& study, const Protocol& protocol, SessionKind kind, const ResultsAsked& asked) {
  ChainReport chains = require_whole_chains(study);
  StudyResults results;
  const std::vector<SessionInfo> sessions = sessions_of(study, kind);
  results.attendance = attendance_of(study, kind, sessions);
  // Held of as many people as are shown one by one.
  const CountedTrials trials(study, protocol, sessions,
                             static_cast<std::size_t>(results.attendance.participants) <= kMostInDetail);
  results.task = task_results(study, protocol, sessions, trials, asked.by);
  add_tests(results, protocol, true);
  add_ratings(results, study, protocol, sessions);
  results.exploration = exploration_results(study, protocol, sessions);
  if (trials.are_held() && !results.task.outcomes.empty())
    results.answers = answer_raster(protocol, sessions, trials.held());
  if (trials.are_held() && !results.task.cells.empty()) {
    results.behaviour = study_behaviour(protocol, sessions, trials.held());
    results.sureness = study_sureness(protocol, sessions, trials.held());
  }
  if (judges_exploration(protocol))
    trials.for_each([&](const CountedTrial& trial) { results.off_prescription += trial.off_prescription ? 1 : 0; });
  add_model_and_contrasts(results, protocol, asked.hierarchical);
  const bool sealed = plan_sealed(study, protocol);
  const bool forgotten = sealed && results.groups && protocol.allotment == Allotment::balanced;
  if (forgotten) forget_groups(results);
  results.deviations = deviations_of(results, protocol);
  results.cautions = cautions_of(results, protocol);
  if (forgotten)
    results.cautions.emplace_back(
        "Groups are not compared while the study is blinded: who is in which group is sealed.");
  if (const std::string words = delivery_caution(study, protocol, kind); !words.empty())
    results.cautions.insert(results.cautions.begin(), words);
  if (sealed) results.answers.clear();  // trial by trial they are the plan that people are to have
  for (SessionHead& head : results.attendance.heads)
    if (sealed && !head.closed) head.hash.clear();  // as shown_head()
  results.chains = std::move(chains);
  return results;
}

StudyResults results_of(const Study& study, const Protocol& protocol, SessionKind kind) {
  return results_of(study, protocol, kind, {.by = registered_source(protocol)});
}

StudyResults results_of(TaskResults task, int participants, const Protocol& protocol, bool hierarchical) {
  StudyResults results;
  results.attendance.participants = participants;
  results.task = std::move(task);
  add_tests(results, protocol, false);
  add_model_and_contrasts(results, protocol, hierarchical);
  results.deviations = deviations_of(results, protocol);
  results.cautions = cautions_of(results, protocol);
  return results;
}

}  // namespace jnd
