#include "data/results/study_results.h"

#include <utility>

#include "data/results/rating_answers.h"

namespace jnd {

namespace {

void add_ratings(StudyResults& results, const Study& study, const Protocol& protocol,
                 const std::vector<SessionInfo>& sessions) {
  const std::vector<std::string> participants = participants_of(sessions);
  const std::vector<RatedQuestion> ratings = read_ratings(study, protocol, sessions);
  for (const RatedQuestion& rated : ratings)
    if (rated.paired) results.comparisons.push_back(compare_ratings(rated, participants, protocol));
  results.questionnaire = questionnaire_of(ratings, participants.size(), protocol);
}

// What follows from the thresholds alone.
void add_tests(StudyResults& results, const Protocol& protocol) {
  const StudyAnalysis& analysis = results.analysis;
  results.comparisons.push_back(compare_thresholds(analysis.thresholds, protocol, protocol.analysis.tests.outcome));
  results.comparisons.back().registered = true;
  results.by_series = compare_series(analysis.cells, protocol);
  results.detailed = static_cast<std::size_t>(analysis.participants) <= kMostInDetail;
  if (results.detailed) results.sensitivity = study_sensitivity(analysis, protocol);
}

void add_remarks(StudyResults& results, const Protocol& protocol) {
  results.deviations = deviations_of(results.analysis, results.comparisons, protocol);
  results.cautions = cautions_of(results.analysis, results.comparisons, protocol);
}

// Of a protocol with a procedure: thresholds of its own kind, compared over the conditions like any other outcome.
StudyResults adaptive_results_of(const Study& study, const Protocol& protocol, SessionKind kind) {
  StudyResults results;
  const std::vector<SessionInfo> sessions = sessions_of(study, kind);
  results.analysis.kind = kind;
  for (const SessionInfo& session : sessions)
    results.analysis.heads.push_back({session.participant, session.id, session.head, kind, session.state == "closed"});
  results.analysis.participants = static_cast<int>(participants_of(sessions).size());
  results.analysis.excluded = excluded_of(study, kind);
  results.adaptive = adaptive_results(study, protocol, kind);
  results.by_series.refused = "the answers set the levels: there are no series";
  results.comparisons.push_back(compare_adaptive(results.adaptive->rows, protocol));
  results.comparisons.back().registered = true;
  add_ratings(results, study, protocol, sessions);
  add_remarks(results, protocol);
  return results;
}

// Of the paradigm explore: questionnaires alone.
StudyResults explore_results_of(const Study& study, const Protocol& protocol, SessionKind kind) {
  StudyResults results;
  const std::vector<SessionInfo> sessions = sessions_of(study, kind);
  results.analysis.kind = kind;
  results.analysis.excluded = excluded_of(study, kind);
  for (const SessionInfo& session : sessions)
    results.analysis.heads.push_back({session.participant, session.id, session.head, kind, session.state == "closed"});
  results.questionnaire = questionnaire_results(study, protocol, sessions);
  results.analysis.participants = results.questionnaire.participants;
  results.by_series.refused = "there are no trials";
  add_remarks(results, protocol);
  for (const std::string& one : exposure_deviations(results.questionnaire, protocol)) results.deviations.push_back(one);
  return results;
}

StudyResults computed_results_of(const Study& study, const Protocol& protocol, SessionKind kind, DifferenceSource by) {
  if (protocol.paradigm == Paradigm::explore) return explore_results_of(study, protocol, kind);
  if (protocol.design.procedure) return adaptive_results_of(study, protocol, kind);
  StudyResults results;
  const std::vector<SessionInfo> sessions = sessions_of(study, kind);
  const std::vector<CountedTrial> trials = read_counted_trials(study, protocol, sessions);
  results.analysis = analyze(study, protocol, kind, by, sessions, trials);
  add_tests(results, protocol);
  results.comparisons.push_back(compare_times(results.analysis.thresholds, protocol));
  add_ratings(results, study, protocol, sessions);
  if (results.detailed) results.behaviour = study_behaviour(protocol, sessions, trials);
  add_remarks(results, protocol);
  return results;
}

}  // namespace

StudyResults results_of(const Study& study, const Protocol& protocol, SessionKind kind, DifferenceSource by) {
  ChainReport chains = require_whole_chains(study);
  StudyResults results = computed_results_of(study, protocol, kind, by);
  results.chains = std::move(chains);
  return results;
}

StudyResults results_of(const Study& study, const Protocol& protocol, SessionKind kind) {
  return results_of(study, protocol, kind, registered_source(protocol));
}

std::vector<ContrastRow> contrasts_of(const StudyResults& results, const Protocol& protocol) {
  if (protocol.paradigm == Paradigm::explore) return {};
  return contrast_rows(results.analysis, results.comparisons.front(), protocol);
}

StudyResults results_of(StudyAnalysis analysis, const Protocol& protocol) {
  StudyResults results;
  results.analysis = std::move(analysis);
  add_tests(results, protocol);
  add_remarks(results, protocol);
  return results;
}

}  // namespace jnd
