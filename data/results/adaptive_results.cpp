#include "data/results/adaptive_results.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "analysis/numerics/special_values.h"
#include "data/log/event_body.h"
#include "data/log/replay.h"
#include "data/log/storage_error.h"
#include "data/results/study_analysis.h"
#include "protocols/planning/adaptive_run.h"
#include "protocols/planning/allotment.h"

namespace jnd {
namespace {

void set_rates(AdaptiveRow& row, double reference) {
  row.false_alarm_rate = row.catch_trials > 0 ? static_cast<double>(row.false_alarms) / row.catch_trials : kNaN;
  row.weber = row.threshold.threshold / reference;
}

AdaptiveRow row_of(const AdaptiveTrack& track, const Protocol& protocol) {
  const AdaptiveProcedure& procedure = *protocol.design.procedure;
  AdaptiveRow row;
  row.condition = track.condition;
  row.track = track.track;
  row.finished = track.finished;
  row.trials = static_cast<int>(track.levels.size());
  row.hits = static_cast<int>(std::count(track.correct.begin(), track.correct.end(), true));
  row.catch_trials = track.catch_trials;
  row.false_alarms = track.false_alarms;
  row.levels = track.levels;
  row.reversals = track.reversals;
  row.threshold =
      by_staircase(protocol)
          ? staircase_threshold(track.levels, track.reversals, procedure.averaged_reversals, procedure.clamp)
          : quest_threshold(track.quest->mean, track.quest->sd, row.trials, procedure.clamp);
  set_rates(row, protocol.stimulus.reference);
  return row;
}

AdaptiveRow sum_of(const std::vector<AdaptiveRow>& tracks, const Protocol& protocol) {
  AdaptiveRow all;
  all.condition = tracks.front().condition;
  all.finished = true;
  std::vector<AdaptiveThreshold> thresholds;
  for (const AdaptiveRow& track : tracks) {
    all.finished = all.finished && track.finished;
    all.trials += track.trials;
    all.hits += track.hits;
    all.catch_trials += track.catch_trials;
    all.false_alarms += track.false_alarms;
    thresholds.push_back(track.threshold);
  }
  all.threshold = by_staircase(protocol) ? combined_staircases(thresholds) : combined_quests(thresholds);
  set_rates(all, protocol.stimulus.reference);
  return all;
}

}  // namespace

namespace {

// Of one session; without answers that were taken back.
std::vector<AdaptiveTrack> tracks_of(const std::vector<Event>& events, const Protocol& protocol,
                                     const std::string& participant) {
  AdaptiveRun run(protocol);
  for (const TrialRecord& record : replay(events).completed) {
    try {
      run.answered(record.trial, record.answer);
    } catch (const std::out_of_range&) {
      throw StorageError(
          fmt::format("participant {}: trial {} belongs to track {} of condition {}, which the protocol "
                      "does not have; run jnd verify",
                      participant, record.trial.index, record.trial.track, record.trial.condition));
    }
  }
  return run.tracks();
}

}  // namespace

std::vector<AdaptiveRow> adaptive_rows(const std::vector<Event>& events, const Protocol& protocol,
                                       const std::string& participant, SessionKind kind) {
  return adaptive_rows(std::vector<std::vector<Event>>{events}, protocol, participant, kind);
}

std::vector<AdaptiveRow> adaptive_rows(const std::vector<std::vector<Event>>& sessions, const Protocol& protocol,
                                       const std::string& participant, SessionKind kind, std::optional<int> group) {
  std::vector<AdaptiveTrack> tracks;
  for (const std::vector<Event>& events : sessions) {
    int before = 0;  // tracks of a condition in the sessions before
    for (const AdaptiveTrack& track : tracks) before = std::max(before, track.track);
    for (AdaptiveTrack& track : tracks_of(events, protocol, participant)) {
      if (!has_condition(protocol, group, track.condition)) continue;
      track.track += before;
      tracks.push_back(std::move(track));
    }
  }
  std::stable_sort(tracks.begin(), tracks.end(),
                   [](const AdaptiveTrack& a, const AdaptiveTrack& b) { return a.condition < b.condition; });
  std::vector<AdaptiveRow> rows, of_condition;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    of_condition.push_back(row_of(tracks[i], protocol));
    if (i + 1 < tracks.size() && tracks[i + 1].condition == tracks[i].condition) continue;
    of_condition.push_back(sum_of(of_condition, protocol));
    rows.insert(rows.end(), of_condition.begin(), of_condition.end());
    of_condition.clear();
  }
  for (AdaptiveRow& row : rows) {
    row.participant = participant;
    row.kind = kind;
    row.group = group;
  }
  return rows;
}

std::vector<AdaptiveGroup> adaptive_group(const std::vector<AdaptiveRow>& rows, const Protocol& protocol) {
  std::vector<AdaptiveGroup> groups;
  for (int condition = 0; condition < static_cast<int>(protocol.conditions.size()); ++condition) {
    AdaptiveGroup group;
    group.condition = condition;
    std::vector<double> thresholds;
    double rates = 0;
    for (const AdaptiveRow& row : rows) {
      if (row.condition != condition || row.track != 0) continue;
      ++group.of;
      if (row.threshold.status != AdaptiveStatus::ok) continue;
      thresholds.push_back(row.threshold.threshold);
      rates += row.false_alarm_rate;
    }
    group.n = static_cast<int>(thresholds.size());
    double sum = 0, squares = 0;
    for (const double threshold : thresholds) sum += threshold;
    group.mean = group.n > 0 ? sum / group.n : kNaN;
    for (const double threshold : thresholds) squares += (threshold - group.mean) * (threshold - group.mean);
    group.sd = group.n > 1 ? std::sqrt(squares / (group.n - 1)) : kNaN;
    group.false_alarms = group.n > 0 ? rates / group.n : kNaN;
    groups.push_back(group);
  }
  return groups;
}

AdaptiveResults adaptive_results(const Study& study, const Protocol& protocol, SessionKind kind) {
  AdaptiveResults results;
  const std::vector<SessionInfo> sessions = sessions_of(study, kind);
  results.attendance = attendance_of(study, kind, sessions);
  for (const std::string& participant : participants_of(sessions)) {
    std::vector<std::vector<Event>> events;
    std::optional<int> group;
    for (const SessionInfo& session : sessions) {
      if (session.participant != participant) continue;
      group = group_named(protocol, session.group);
      events.push_back(study.events(session.id));
    }
    const std::vector<AdaptiveRow> rows = adaptive_rows(events, protocol, participant, kind, group);
    results.rows.insert(results.rows.end(), rows.begin(), rows.end());
  }
  results.group = adaptive_group(results.rows, protocol);
  return results;
}

double adaptive_target(const AdaptiveProcedure& procedure) {
  return procedure.kind == AdaptiveProcedure::Kind::staircase ? staircase_target(procedure.staircase)
                                                              : procedure.quest.p_threshold;
}

bool by_staircase(const Protocol& protocol) noexcept {
  return protocol.design.procedure->kind == AdaptiveProcedure::Kind::staircase;
}

}  // namespace jnd
