#include "runner/results/blinded_results.h"

#include <algorithm>
#include <map>

#include "analysis/numerics/moments.h"
#include "analysis/numerics/special_values.h"
#include "data/log/event_body.h"
#include "data/results/attendance.h"
#include "protocols/condition_words.h"
#include "runner/terminal/terminal.h"

namespace jnd {

namespace {

// What is added up over the sessions of one participant.
struct Tally {
  BlindedParticipant row;
  int closed = 0, answers = 0, different = 0;
  bool excluded = false, ended_early = false;
  double seconds = 0;
  std::vector<double> response_times;
};

int faults_of(const Study& study, const std::string& session) {
  const std::vector<Event> events = study.events(session);
  return static_cast<int>(std::count_if(events.begin(), events.end(),
                                        [](const Event& event) { return event.kind == event_kind::kDeviceFault; }));
}

void add_session(Tally& tally, const Study& study, const SessionInfo& session) {
  tally.row.participant = session.participant;
  ++tally.row.sessions;
  tally.closed += session.state == "closed" && !session.ended_early ? 1 : 0;
  tally.ended_early = tally.ended_early || session.ended_early;
  tally.excluded = tally.excluded || session.excluded;
  tally.row.trials_done += session.trials_done;
  tally.row.trials_total += session.trials_total;
  tally.row.trials_voided += session.trials_voided;
  tally.row.device_faults += faults_of(study, session.id);
}

void add_trial(Tally& tally, const CountedTrial& trial) {
  ++tally.answers;
  tally.different += trial.said_different() ? 1 : 0;
  tally.seconds += trial.duration_s;
  if (trial.by_participant) tally.response_times.push_back(trial.response_time_s);
}

BlindedParticipant summed(Tally tally, const Protocol& protocol) {
  BlindedParticipant row = std::move(tally.row);
  const double answers = tally.answers > 0 ? tally.answers : kNaN;
  row.state = tally.excluded                             ? "excluded"
              : tally.closed >= protocol.design.sessions ? "finished"
              : tally.ended_early                        ? "ended early"
                                                         : "not finished";
  row.said_different = protocol.explore || !task_of(protocol.task.kind).has_pairs() ? kNaN : tally.different / answers;
  row.mean_trial_s = tally.seconds / answers;
  row.median_response_time_s = median_of(tally.response_times);
  return row;
}

BlindedGroup together(BlindedGroup row) {
  if (row.n >= kFewestTogether) return row;
  row.n.reset();
  row.mean = row.ci_low = row.ci_high = kNaN;
  return row;
}

// The registered outcome, or the JND of pairs, where the task has one estimate in a condition.
std::vector<BlindedGroup> groups_of(const Study& study, const Protocol& protocol, DifferenceSource by) {
  const std::vector<std::string> codes = condition_codes(protocol, study.info().seed);
  std::vector<BlindedGroup> rows;
  if (protocol.explore || !task_of(protocol.task.kind).has_pairs()) return rows;
  const std::vector<SessionInfo> sessions = sessions_of(study, SessionKind::real);
  const TaskResults results =
      task_results(study, protocol, sessions, CountedTrials(study, protocol, sessions, false), by);
  for (const TaskGroupRow& row : results.group)
    if (const std::string_view key = results.outcomes[row.outcome].key; key == "jnd" || key == "threshold")
      rows.push_back(together({codes.at(static_cast<std::size_t>(row.condition)), row.mean.n, row.participants,
                               row.mean.mean, row.mean.ci_low, row.mean.ci_high}));
  // In the order of the letters, which says nothing about the order in the protocol.
  std::sort(rows.begin(), rows.end(), [](const BlindedGroup& a, const BlindedGroup& b) { return a.code < b.code; });
  return rows;
}

}  // namespace

BlindedResults blinded_results(const Study& study, const Protocol& protocol, SessionKind kind, DifferenceSource by,
                               const std::string& study_name) {
  BlindedResults results;
  results.kind = kind;
  results.chains = require_whole_chains(study);
  results.state = blinding_of(study, protocol, kind);
  results.line = blinding_line(results.state, shell_word(study_name));
  std::vector<SessionInfo> sessions = study.sessions();
  std::erase_if(sessions, [kind](const SessionInfo& session) { return session.kind != kind; });
  if (sessions.empty()) return results;

  std::map<std::string, Tally> tallies;
  std::vector<std::string> order;  // of the participants' numbers, as the sessions are
  for (const SessionInfo& session : sessions) {
    if (!tallies.contains(session.participant)) order.push_back(session.participant);
    add_session(tallies[session.participant], study, session);
  }
  for_counted_trials(study, protocol, sessions, [&](const CountedTrial& trial) {
    add_trial(tallies[sessions[static_cast<std::size_t>(trial.session)].participant], trial);
  });
  for (const std::string& participant : order)
    results.participants.push_back(summed(std::move(tallies[participant]), protocol));
  if (kind == SessionKind::real) results.groups = groups_of(study, protocol, by);
  return results;
}

}  // namespace jnd
