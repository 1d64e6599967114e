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
#include "protocols/tasks/posterior_model.h"

namespace jnd {
namespace {

void set_rates(AdaptiveRow& row, double reference) {
  row.false_alarm_rate = row.catch_trials > 0 ? static_cast<double>(row.false_alarms) / row.catch_trials : kNaN;
  row.weber = row.threshold.threshold / reference;
}

// The answers of a track, for the response model of same-different.
std::vector<PosteriorAnswer> answers_of(const AdaptiveTrack& track) {
  std::vector<PosteriorAnswer> answers;
  for (std::size_t i = 0; i < track.levels.size(); ++i) answers.push_back({track.levels[i], track.correct[i]});
  for (int i = 0; i < track.catch_trials; ++i) answers.push_back({0, i < track.false_alarms});
  return answers;
}

AdaptiveThreshold threshold_of(const std::vector<PosteriorAnswer>& answers, const Protocol& protocol) {
  return posterior_of_answers(posterior_model(protocol, protocol.series.front()).configuration, answers).threshold;
}

AdaptiveThreshold threshold_of(const AdaptiveTrack& track, const Protocol& protocol) {
  const AdaptiveProcedure& procedure = *protocol.design.procedure;
  switch (threshold_source(protocol)) {
    case ThresholdSource::reversals:
      return staircase_threshold(track.levels, track.reversals, procedure.averaged_reversals, procedure.clamp);
    case ThresholdSource::quest:
      return quest_threshold(track.quest->mean, track.quest->sd, static_cast<int>(track.levels.size()),
                             procedure.clamp);
    case ThresholdSource::answers:
      break;
  }
  return threshold_of(answers_of(track), protocol);
}

AdaptiveRow row_of(const AdaptiveTrack& track, const Protocol& protocol) {
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
  row.threshold = threshold_of(track, protocol);
  set_rates(row, protocol.stimulus.reference);
  return row;
}

// answers: of all these tracks.
AdaptiveRow sum_of(const std::vector<AdaptiveRow>& tracks, const std::vector<PosteriorAnswer>& answers,
                   const Protocol& protocol) {
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
  const ThresholdSource source = threshold_source(protocol);
  all.threshold = source == ThresholdSource::reversals ? combined_staircases(thresholds)
                  : source == ThresholdSource::quest   ? combined_quests(thresholds)
                                                       : threshold_of(answers, protocol);
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
  std::vector<PosteriorAnswer> answers;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    of_condition.push_back(row_of(tracks[i], protocol));
    const std::vector<PosteriorAnswer> of_track = answers_of(tracks[i]);
    answers.insert(answers.end(), of_track.begin(), of_track.end());
    if (i + 1 < tracks.size() && tracks[i + 1].condition == tracks[i].condition) continue;
    of_condition.push_back(sum_of(of_condition, answers, protocol));
    rows.insert(rows.end(), of_condition.begin(), of_condition.end());
    of_condition.clear();
    answers.clear();
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

std::optional<double> adaptive_target(const AdaptiveProcedure& procedure) {
  switch (procedure.kind) {
    case AdaptiveProcedure::Kind::staircase:
      return staircase_target(procedure.staircase);
    case AdaptiveProcedure::Kind::quest:
      return procedure.quest.p_threshold;
    case AdaptiveProcedure::Kind::posterior:
      break;
  }
  return std::nullopt;
}

ThresholdSource threshold_source(const Protocol& protocol) noexcept {
  if (has_posterior_threshold(protocol)) return ThresholdSource::answers;
  return protocol.design.procedure->kind == AdaptiveProcedure::Kind::staircase ? ThresholdSource::reversals
                                                                               : ThresholdSource::quest;
}

}  // namespace jnd
