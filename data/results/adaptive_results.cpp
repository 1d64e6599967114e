#include "data/results/adaptive_results.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <utility>

#include "analysis/numerics/special_values.h"
#include "data/results/study_analysis.h"
#include "data/task_results/participant_tracks.h"
#include "data/task_results/task_results.h"
#include "protocols/planning/adaptive_run.h"
#include "protocols/planning/allotment.h"
#include "protocols/planning/track_threshold.h"

namespace jnd {
namespace {

void set_rates(AdaptiveRow& row, double reference) {
  row.false_alarm_rate = row.catch_trials > 0 ? static_cast<double>(row.false_alarms) / row.catch_trials : kNaN;
  row.weber = row.threshold.threshold / reference;
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
  row.course = track.course;
  row.threshold = track_threshold(track, protocol);
  set_rates(row, protocol.stimulus.reference);
  return row;
}

// rows: of these tracks.
AdaptiveRow sum_of(const std::vector<AdaptiveRow>& rows, std::span<const AdaptiveTrack> tracks,
                   const Protocol& protocol) {
  AdaptiveRow all;
  all.condition = rows.front().condition;
  all.finished = true;
  for (const AdaptiveRow& row : rows) {
    all.finished = all.finished && row.finished;
    all.trials += row.trials;
    all.hits += row.hits;
    all.catch_trials += row.catch_trials;
    all.false_alarms += row.false_alarms;
  }
  all.threshold = condition_threshold(tracks, protocol);
  set_rates(all, protocol.stimulus.reference);
  return all;
}

}  // namespace

std::vector<AdaptiveRow> adaptive_rows(const std::vector<Event>& events, const Protocol& protocol,
                                       const std::string& participant, SessionKind kind) {
  return adaptive_rows(std::vector<std::vector<Event>>{events}, protocol, participant, kind);
}

namespace {

std::vector<AdaptiveRow> rows_of(const std::vector<AdaptiveTrack>& tracks, const Protocol& protocol,
                                 const std::string& participant, SessionKind kind, std::optional<int> group) {
  std::vector<AdaptiveRow> rows, of_condition;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    of_condition.push_back(row_of(tracks[i], protocol));
    if (i + 1 < tracks.size() && tracks[i + 1].condition == tracks[i].condition) continue;
    const std::size_t count = of_condition.size();
    of_condition.push_back(sum_of(of_condition, std::span(tracks).subspan(i + 1 - count, count), protocol));
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

}  // namespace

std::vector<AdaptiveRow> adaptive_rows(const std::vector<std::vector<Event>>& sessions, const Protocol& protocol,
                                       const std::string& participant, SessionKind kind, std::optional<int> group) {
  return rows_of(participant_tracks(sessions, protocol, participant, group), protocol, participant, kind, group);
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
  for (std::span rest = std::span<const SessionInfo>(sessions); !rest.empty();) {
    const std::span<const SessionInfo> own = sessions_of_next(rest);
    rest = rest.subspan(own.size());
    const std::vector<AdaptiveRow> rows =
        rows_of(participant_tracks(study, protocol, own), protocol, own.front().participant, kind,
                group_named(protocol, own.front().group));
    results.rows.insert(results.rows.end(), rows.begin(), rows.end());
  }
  results.group = adaptive_group(results.rows, protocol);
  return results;
}

void add_answers(AdaptiveResults& results, const Protocol& protocol, const std::vector<SessionInfo>& sessions,
                 const CountedTrials& trials) {
  std::map<std::pair<std::string, int>, std::vector<AnsweredTrial>> by_cell;  // participant and condition
  trials.for_each([&](const CountedTrial& trial) {
    by_cell[{sessions[static_cast<std::size_t>(trial.session)].participant, trial.condition}].push_back(
        answered(trial));
  });
  for (AdaptiveRow& row : results.rows)
    if (row.track == 0) row.answers = level_counts(by_cell[{row.participant, row.condition}], protocol);
}

}  // namespace jnd
