#include "runner/results/blinded_results.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "analysis/numerics/moments.h"
#include "analysis/numerics/special_values.h"
#include "data/blocks/common_fields.h"
#include "data/log/event_body.h"
#include "data/results/attendance.h"
#include "protocols/condition_words.h"
#include "runner/results/block_output.h"
#include "runner/results/result_format.h"
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

namespace {

Block monitoring_block(const BlindedResults& results) {
  using R = BlindedParticipant;
  using F = Field<R>;
  const Fields<R> fields = {
      common<R>("participant", &R::participant),
      F("state", "how far the participant is", &R::state,
        {.levels = "finished \"not finished\" \"ended early\" excluded"}),
      F("sessions", "sessions that were opened", &R::sessions),
      F("trials_done", "main trials answered, over all sessions", &R::trials_done),
      F("trials_total", "main trials planned", &R::trials_total),
      F("trials_voided", "attempts voided, practice included", &R::trials_voided, {.title = "voided"}),
      F("device_faults", "presentations that a fault stopped", &R::device_faults, {.title = "device faults"}),
      F("said_different", "share of \"different\" answers", &R::said_different,
        {.title = "said different", .shown = Shown::percent}),
      F("median_response_time_s", "median of the times that the participant entered; empty without one",
        &R::median_response_time_s, {.unit = "s", .title = "median response s"}),
      F("mean_trial_s", "mean time of a counted trial; empty without one", &R::mean_trial_s,
        {.unit = "s", .title = "s per trial"})};
  Block block;
  block.id = "monitoring";
  block.section = Section::participants;
  block.title = "Participants";
  block.note = "pooled over conditions and stimuli; how often a participant is right is not shown";
  block.columns = {
      {"participant"},   {"state"},         {"sessions"},       share("trials_done", "trials_total", "trials"),
      {"trials_voided"}, {"device_faults"}, {"said_different"}, {"median_response_time_s"},
      {"mean_trial_s"}};
  return std::move(block.with(fields, results.participants));
}

Block coded_block(const BlindedResults& results, const Protocol& protocol) {
  using R = BlindedGroup;
  using F = Field<R>;
  const std::string unit(unit_of(protocol));
  const std::string title = fmt::format("mean {}", unit);
  const Fields<R> fields = {
      F("condition_code", "letter of the condition on the operator's console", &R::code, {.title = "condition"}),
      common<R>("n", &R::n),
      common<R>("participants", &R::of),
      common<R>("mean", &R::mean, {.unit = unit, .title = title}),
      common<R>("ci_low", &R::ci_low, {.unit = unit}),
      common<R>("ci_high", &R::ci_high, {.unit = unit}),
      common<R>("unit", [&protocol](const R&) { return unit_of(protocol); }),
      common<R>("status", [](const R& r) { return r.n ? "ok" : "too_few_participants"; },
                {.levels = "ok too_few_participants"})};
  Block block;
  block.id = "coded";
  block.section = Section::participants;
  block.title = "Group by coded condition";
  block.note = fmt::format(
      "the letters of the operator's console; a mean stands from {} participants on, so that it is nobody's own",
      kFewestTogether);
  block.columns = {{"condition_code"}, share("n", "participants", "n used"), {"mean"}, range("ci_low", "ci_high")};
  return std::move(block.with(fields, results.groups));
}

}  // namespace

std::vector<Block> blinded_blocks(const BlindedResults& results, const Protocol& protocol) {
  std::vector<Block> blocks;
  blocks.push_back(monitoring_block(results));
  blocks.push_back(coded_block(results, protocol));
  return blocks;
}

nlohmann::ordered_json to_json(const BlindingState& state) {
  return {{"blinded", state.blinded},
          {"participants_planned", state.planned},
          {"participants_finished", state.finished},
          {"sessions_open", state.unfinished}};
}

nlohmann::ordered_json to_json(const BlindedResults& results, const Protocol& protocol) {
  nlohmann::ordered_json out = {{"kind", to_string(results.kind)}, {"blinding", to_json(results.state)}};
  out["blinding"]["why"] = results.line;
  out["protocol_sha256"] = protocol.sha256;
  out["events_verified"] = results.chains.events;
  out["study_head"] = results.chains.study_head;
  for (const Block& block : blinded_blocks(results, protocol)) out[block.id] = json_rows(block);
  return out;
}

}  // namespace jnd
