#include "data/study_results.h"

#include <utility>

#include "data/rating_answers.h"

namespace jnd {

namespace {

// Beyond this a table of everybody is not read by anybody, and the other models are left to those who ask for them.
constexpr int kMostDetailed = 500;

void add_ratings(StudyResults& results, const Study& study, const Protocol& protocol,
                 const std::vector<SessionInfo>& sessions) {
  std::vector<std::string> participants;
  for (const SessionInfo& session : sessions) participants.push_back(session.participant);
  std::vector<PairedItem> paired;
  std::vector<ComparativeItem> once;
  for (RatedQuestion& rated : read_ratings(study, protocol, sessions)) {
    const std::string& id = protocol.questions[static_cast<std::size_t>(rated.question)].id;
    if (!rated.paired) {
      once.push_back({id, std::move(rated.ratings)});
      continue;
    }
    results.comparisons.push_back(compare_ratings(rated, participants, protocol));
    paired.push_back({id, {sessions.size(), protocol.conditions.size(), std::move(rated.ratings)}});
  }
  results.ratings = paired_questionnaire(paired);
  results.comparative = comparative_questionnaire(once);
}

// What follows from the thresholds alone.
void add_tests(StudyResults& results, const Protocol& protocol) {
  const StudyAnalysis& analysis = results.analysis;
  results.comparisons.push_back(compare_thresholds(analysis.thresholds, protocol, protocol.analysis.tests.outcome));
  results.comparisons.back().registered = true;
  results.by_series = compare_series(analysis.cells, protocol);
  results.detailed = analysis.participants <= kMostDetailed;
  if (results.detailed) results.sensitivity = study_sensitivity(analysis, protocol);
}

void add_remarks(StudyResults& results, const Protocol& protocol) {
  results.deviations = deviations_of(results.analysis, results.comparisons, protocol);
  results.warnings = warnings_of(results.analysis, results.comparisons, protocol);
}

}  // namespace

StudyResults results_of(const Study& study, const Protocol& protocol, SessionKind kind, DifferenceSource by) {
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

StudyResults results_of(const Study& study, const Protocol& protocol, SessionKind kind) {
  return results_of(study, protocol, kind, registered_source(protocol));
}

StudyResults results_of(StudyAnalysis analysis, const Protocol& protocol) {
  StudyResults results;
  results.analysis = std::move(analysis);
  add_tests(results, protocol);
  add_remarks(results, protocol);
  return results;
}

}  // namespace jnd
