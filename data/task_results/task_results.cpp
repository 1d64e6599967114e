#include "data/task_results/task_results.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "analysis/group/compare.h"
#include "analysis/numerics/moments.h"
#include "analysis/numerics/tail_probabilities.h"
#include "analysis/thresholds/jnd.h"
#include "data/task_results/participant_tracks.h"
#include "protocols/planning/allotment.h"
#include "protocols/planning/track_threshold.h"
#include "protocols/tasks/level_source.h"

namespace jnd {
namespace {

std::size_t place(int index) {
  return static_cast<std::size_t>(index);
}

int standards_in(const Protocol& protocol) {
  return static_cast<int>(judged_standard_count(protocol));
}

// Everything of one participant, condition and standard, before it is turned into estimates.
struct TaskCell {
  std::vector<AnsweredTrial> trials;
  std::vector<double> response_times_s;
  double sum_s = 0;
  int excluded = 0;
};

struct ParticipantCells {
  std::string participant;
  std::optional<int> group;
  std::vector<TaskCell> cells;          // conditions x standards
  std::vector<AdaptiveTrack> tracks{};  // by condition and series
};

auto key_of(const AnsweredTrial& trial) {
  std::array<double, kMostIntervals> stimuli{};
  std::copy(trial.stimuli.begin(), trial.stimuli.end(), stimuli.begin());
  return std::tuple(stimuli, trial.said, trial.sureness, trial.number.value_or(0));
}

void add_counts(TaskResults& results, const TaskEstimateRow& row, std::vector<AnsweredTrial> trials) {
  std::stable_sort(trials.begin(), trials.end(),
                   [](const AnsweredTrial& a, const AnsweredTrial& b) { return key_of(a) < key_of(b); });
  for (std::size_t i = 0; i < trials.size(); ++i) {
    if (i == 0 || key_of(trials[i]) != key_of(trials[i - 1]))
      results.counts.push_back({row.participant, row.kind, row.condition, row.standard, trials[i].stimuli,
                                trials[i].target, trials[i].said, trials[i].sureness, trials[i].number, 0, row.group});
    ++results.counts.back().n;
  }
}

std::span<const AdaptiveTrack> tracks_in(const std::vector<AdaptiveTrack>& tracks, int condition, int series) {
  const auto is_there = [&](const AdaptiveTrack& track) {
    return track.condition == condition && track.series == series;
  };
  const auto first = std::find_if(tracks.begin(), tracks.end(), is_there);
  return {first, std::find_if_not(first, tracks.end(), is_there)};
}

// Rows of the tracks of one participant, condition and standard, and of all of them.
std::vector<TrackRow> track_rows(std::span<const AdaptiveTrack> tracks, const TrackRow& of, const Protocol& protocol) {
  const bool thresholds = tracks_have_thresholds(protocol);
  std::vector<TrackRow> rows;
  TrackRow all = of;
  all.finished = true;
  for (const AdaptiveTrack& track : tracks) {
    TrackRow row = of;
    row.track = track.track;
    row.finished = track.finished;
    row.trials = static_cast<int>(track.levels.size());
    row.hits = static_cast<int>(std::count(track.correct.begin(), track.correct.end(), true));
    row.catch_trials = track.catch_trials;
    row.false_alarms = track.false_alarms;
    row.levels = track.levels;
    row.reversals = track.reversals;
    row.course = track.course;
    if (thresholds) row.threshold = track_threshold(track, protocol);
    all.finished = all.finished && row.finished;
    all.trials += row.trials;
    all.hits += row.hits;
    all.catch_trials += row.catch_trials;
    all.false_alarms += row.false_alarms;
    rows.push_back(std::move(row));
  }
  if (thresholds) all.threshold = condition_threshold(tracks, protocol);
  rows.push_back(std::move(all));
  return rows;
}

void add_estimates(TaskResults& results, const Protocol& protocol, const ParticipantCells& data, SessionKind kind) {
  const int standards = standards_in(protocol);
  for (const int condition : conditions_of(protocol, data.group)) {
    for (int standard = 0; standard < standards; ++standard) {
      const TaskCell& cell = data.cells[place(condition * standards + standard)];
      const std::span<const AdaptiveTrack> tracks = tracks_in(data.tracks, condition, standard);
      TaskEstimateRow row;
      row.group = data.group;
      row.participant = data.participant;
      row.kind = kind;
      row.condition = condition;
      row.standard = standard;
      row.trials = static_cast<int>(cell.trials.size());
      row.excluded = cell.excluded;
      // A procedure's tracks end where the answers end them.
      if (levels_given(protocol))
        row.missing =
            std::max(0, protocol.design.sessions * trials_of_cell(protocol, standard) - row.trials - row.excluded);
      if (cell.trials.empty()) {
        row.estimates = {"no_trials", std::vector<TaskEstimate>(results.outcomes.size())};
      } else {
        row.estimates = measured_estimates(protocol, protocol.series[place(standard)], cell.trials, tracks);
        row.mean_trial_s = cell.sum_s / row.trials;
        row.answers = level_counts(cell.trials, protocol);
      }
      if (!cell.response_times_s.empty()) row.median_response_time_s = median_of(cell.response_times_s);
      if (!tracks.empty()) {
        const TrackRow of{data.participant, kind, data.group, condition, standard};
        std::vector<TrackRow> rows = track_rows(tracks, of, protocol);
        row.catch_trials = rows.back().catch_trials;
        row.false_alarms = rows.back().false_alarms;
        std::move(rows.begin(), rows.end(), std::back_inserter(results.tracks));
      }
      add_counts(results, row, cell.trials);
      results.estimates.push_back(std::move(row));
    }
  }
}

// The median of values, with those who lie beyond them. Of two in the middle that are not both values the one that is none
// decides: half of its way to the other would be nobody's.
void set_median(TaskGroupRow& row, std::vector<double> values, int below, int above) {
  values.insert(values.end(), static_cast<std::size_t>(below), -kInf);
  values.insert(values.end(), static_cast<std::size_t>(above), kInf);
  row.median_n = static_cast<int>(values.size());
  if (values.empty()) return;
  std::sort(values.begin(), values.end());
  if (std::isinf(values[values.size() / 2]) && values[values.size() / 2] > 0) {
    row.middle = Beyond::above;
    row.median = kInf;
  } else if (std::isinf(values[(values.size() - 1) / 2])) {
    row.middle = Beyond::below;
  } else {
    row.median = median_of(values);
  }
}

void set_means(TaskGroupRow& row, const std::vector<double>& values, const TaskOutcome& outcome) {
  row.mean = mean_with_ci(values);
  if (outcome.may_lack && row.mean.mean > kLeastSlope) row.inverse_mean = 1 / row.mean.mean;
  if (!outcome.positive) return;
  std::vector<double> logarithms;
  for (const double value : values) logarithms.push_back(std::log(value));
  row.logarithms = mean_with_ci(logarithms);
}

TaskGroupRow group_row(const TaskResults& results, int condition, int standard, std::size_t outcome) {
  TaskGroupRow row;
  row.condition = condition;
  row.standard = standard;
  row.outcome = outcome;
  std::vector<double> values, rates;
  std::vector<DifferenceSource> sources;
  int below = 0, above = 0;
  for (const TaskEstimateRow& one : results.estimates) {
    if (one.condition != condition || one.standard != standard) continue;
    ++row.participants;
    const TaskEstimate& estimate = one.estimates.values[outcome];
    if (one.estimates.series_used > 0) sources.push_back(one.difference_source);
    if (estimate.value && std::isfinite(*estimate.value)) {
      values.push_back(*estimate.value);
      rates.push_back(one.catch_trials > 0 ? static_cast<double>(one.false_alarms) / one.catch_trials : kNaN);
    } else {
      ++row.without[reason_without(one.estimates, outcome)];
      below += estimate.beyond == Beyond::below ? 1 : 0;
      above += estimate.beyond == Beyond::above ? 1 : 0;
    }
  }
  set_means(row, values, results.outcomes[outcome]);
  if (results.outcomes[outcome].share) keep_within_0_and_1(row.mean.ci_low, row.mean.ci_high);
  set_median(row, std::move(values), below, above);
  row.false_alarm_rate = mean_with_ci(rates).mean;
  row.difference_source = combined(sources);
  return row;
}

// Of the participants who have a value of an outcome under every condition, at one standard.
WithinTable complete_values(const TaskResults& results, const Protocol& protocol, int standard, std::size_t outcome) {
  const std::size_t conditions = protocol.conditions.size();
  WithinTable table{0, conditions, {}};
  for (const ParticipantRows& one : by_participant(results.estimates, conditions)) {
    std::vector<double> own;
    for (const TaskEstimateRow* const first : one.of) {
      const double value = first == nullptr ? kNaN : (first + standard)->estimates.values[outcome].value.value_or(kNaN);
      if (std::isfinite(value)) own.push_back(value);
    }
    if (own.size() < conditions) continue;
    table.values.insert(table.values.end(), own.begin(), own.end());
    ++table.n;
  }
  return table;
}

// Slope of ln(outcome) on ln(standard), of a Weber fraction that of its JND; none with fewer than two different standards, or
// a value that has no logarithm.
std::optional<double> exponent_of(const TaskEstimateRow& first, const TaskResults& results, const Protocol& protocol) {
  const std::vector<JudgedStandard> standards = judged_standards(protocol);
  std::vector<double> x, y;
  for (const TaskEstimateRow& row : standards_from(first, protocol)) {
    const std::optional<double>& value = row.estimates.values[results.registered].value;
    const double standard = standards[place(row.standard)].value;
    if (!value || !(*value > 0) || !std::isfinite(*value) || !(standard > 0)) return std::nullopt;
    x.push_back(std::log(standard));
    // A share of the standard grows with it as its JND does, less 1.
    y.push_back(std::log(*value) + (results.outcomes[results.registered].of_standard ? x.back() : 0));
  }
  double mean_x = 0, mean_y = 0, xx = 0, xy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    mean_x += x[i] / static_cast<double>(x.size());
    mean_y += y[i] / static_cast<double>(x.size());
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - mean_x) * (x[i] - mean_x);
    xy += (x[i] - mean_x) * (y[i] - mean_y);
  }
  return xx > 0 ? std::optional(xy / xx) : std::nullopt;
}

void add_proportion(TaskResults& results, const Protocol& protocol) {
  if (standards_in(protocol) < 2 || !results.outcomes[results.registered].positive) return;
  for (int condition = 0; condition < static_cast<int>(protocol.conditions.size()); ++condition) {
    std::vector<double> exponents;
    for (const TaskEstimateRow& row : results.estimates) {
      if (row.condition != condition || row.standard != 0) continue;
      if (const auto exponent = exponent_of(row, results, protocol)) exponents.push_back(*exponent);
    }
    ProportionRow row{condition, mean_with_ci(exponents), kNaN};
    const double n = row.exponent.n;
    if (n >= 2 && row.exponent.sd > 0)
      row.p = student_t_two_sided((row.exponent.mean - 1) / (row.exponent.sd / std::sqrt(n)), n - 1);
    results.proportion.push_back(row);
  }
}

void add_curves(TaskResults& results, const Protocol& protocol, const std::vector<ParticipantCells>& participants) {
  const int standards = standards_in(protocol);
  for (int condition = 0; condition < static_cast<int>(protocol.conditions.size()); ++condition) {
    for (int standard = 0; standard < standards; ++standard) {
      std::vector<AnsweredTrial> all;
      for (const ParticipantCells& data : participants) {
        const TaskCell& cell = data.cells[place(condition * standards + standard)];
        all.insert(all.end(), cell.trials.begin(), cell.trials.end());
      }
      if (all.empty()) continue;
      if (auto curve = task_of(protocol.task.kind).curve(protocol, protocol.series[place(standard)], all))
        results.curves.push_back({condition, standard, std::move(*curve)});
    }
  }
}

// Every answer one by one, for the task's own estimates.
void add_answers(TaskResults& results, const Study& study, const Protocol& protocol,
                 const std::vector<SessionInfo>& sessions, const CountedTrials& trials) {
  std::vector<ParticipantCells> participants;
  std::vector<std::size_t> participant_of;  // session -> place in participants
  const auto standards = place(standards_in(protocol));
  for (const SessionInfo& session : sessions) {
    if (participants.empty() || participants.back().participant != session.participant)
      participants.push_back({session.participant, group_named(protocol, session.group),
                              std::vector<TaskCell>(protocol.conditions.size() * standards)});
    participant_of.push_back(participants.size() - 1);
  }
  trials.for_each([&](const CountedTrial& trial) {
    TaskCell& cell = participants[participant_of[place(trial.session)]]
                         .cells[place(trial.condition) * standards + std::min(place(trial.series), standards - 1)];
    // An excluded answer of a procedure has moved the levels all the same.
    const std::string_view reason =
        levels_given(protocol) ? exclusion_reason(protocol.analysis.exclude, trial) : std::string_view();
    if (!reason.empty()) {
      ++cell.excluded;
      ++results.exclusions[std::string(reason)];
      return;
    }
    cell.trials.push_back(answered(trial));
    cell.sum_s += trial.duration_s;
    if (trial.by_participant) cell.response_times_s.push_back(trial.response_time_s);
  });
  const SessionKind kind = sessions.empty() ? SessionKind::simulated : sessions.front().kind;
  if (!levels_given(protocol)) {
    std::span<const SessionInfo> rest = sessions;
    for (ParticipantCells& data : participants) {
      const std::span<const SessionInfo> own = sessions_of_next(rest);
      data.tracks = participant_tracks(study, protocol, own);
      rest = rest.subspan(own.size());
    }
  }
  for (const ParticipantCells& data : participants) add_estimates(results, protocol, data, kind);
  add_curves(results, protocol, participants);
}

}  // namespace

bool tracks_have_thresholds(const Protocol& protocol) {
  return task_of(protocol.task.kind).evidence(protocol) == Evidence::tracks ||
         threshold_source(protocol) != ThresholdSource::answers;
}

std::string reason_without(const TaskEstimates& estimates, std::size_t outcome) {
  const TaskEstimate& estimate = estimates.values[outcome];
  if (estimates.status != "ok") return estimates.status;
  if (!estimate.why.empty()) return std::string(estimate.why);
  return estimate.value ? "infinite" : "undefined";
}

AnsweredTrial answered(const CountedTrial& trial) {
  return {trial.asked, trial.standard, trial.target, trial.said, trial.sureness, trial.number, trial.standard_place};
}

TaskResults empty_task_results(const Protocol& protocol) {
  TaskResults results;
  if (protocol.explore) return results;
  results.outcomes = measured_outcomes(protocol);
  const Outcome compared = protocol.analysis.tests.outcome;
  const std::string_view key = task_of(protocol.task.kind).evidence(protocol) == Evidence::counts
                                   ? (compared == Outcome::slope ? "slope" : "jnd")
                                   : std::string_view(protocol.analysis.outcome);
  for (std::size_t i = 0; i < results.outcomes.size(); ++i)
    if (results.outcomes[i].key == key) results.registered = i;
  results.logarithm = compared == Outcome::log_jnd && results.outcomes[results.registered].positive &&
                      task_of(protocol.task.kind).evidence(protocol) != Evidence::tracks;
  return results;
}

TaskResults task_results(const Study& study, const Protocol& protocol, const std::vector<SessionInfo>& sessions,
                         const CountedTrials& trials, DifferenceSource by) {
  TaskResults results = empty_task_results(protocol);
  if (results.outcomes.empty()) return results;
  if (task_of(protocol.task.kind).evidence(protocol) == Evidence::counts)
    add_pairs(results, protocol, sessions, trials, by, study.info().seed);
  else
    add_answers(results, study, protocol, sessions, trials);
  add_group(results, protocol);
  return results;
}

void add_group(TaskResults& results, const Protocol& protocol) {
  const int standards = standards_in(protocol);
  for (int condition = 0; condition < static_cast<int>(protocol.conditions.size()); ++condition)
    for (int standard = 0; standard < standards; ++standard)
      for (std::size_t outcome = 0; outcome < results.outcomes.size(); ++outcome)
        results.group.push_back(group_row(results, condition, standard, outcome));
  for (int standard = 0; standard < standards; ++standard)
    for (std::size_t outcome = 0; outcome < results.outcomes.size(); ++outcome) {
      const WithinTable table = complete_values(results, protocol, standard, outcome);
      if (table.n < 2 || table.k < 2) continue;
      const std::vector<ConditionSummary> summaries = summaries_of(table);
      for (TaskGroupRow& row : results.group) {
        if (row.standard != standard || row.outcome != outcome) continue;
        const ConditionSummary& within = summaries[place(row.condition)];
        row.within_n = within.n;
        row.within_low = within.ci_within_low;
        row.within_high = within.ci_within_high;
        if (results.outcomes[outcome].share) keep_within_0_and_1(row.within_low, row.within_high);
      }
    }
  add_proportion(results, protocol);
}

std::span<const TaskEstimateRow> standards_from(const TaskEstimateRow& first, const Protocol& protocol) noexcept {
  return {&first, place(standards_in(protocol))};
}

std::span<const TaskEstimateRow> compared_standards(const TaskEstimateRow& first, const Protocol& protocol) noexcept {
  if (protocol.analysis.standard >= 0) return {&first + protocol.analysis.standard, 1};
  return standards_from(first, protocol);
}

double outcome_value(const TaskEstimateRow& first, std::size_t outcome, const Protocol& protocol, bool logarithms) {
  double sum = 0;
  const std::span<const TaskEstimateRow> standards = compared_standards(first, protocol);
  for (const TaskEstimateRow& row : standards) {
    const std::optional<double>& value = row.estimates.values[outcome].value;
    if (!value || !std::isfinite(*value)) return kNaN;
    sum += logarithms ? std::log(*value) : *value;
  }
  return std::isfinite(sum) ? sum / static_cast<double>(standards.size()) : kNaN;
}

double registered_value(const TaskEstimateRow& first, const TaskResults& results, const Protocol& protocol) {
  return outcome_value(first, results.registered, protocol, results.logarithm);
}

std::vector<ParticipantRows> by_participant(const std::vector<TaskEstimateRow>& rows, std::size_t conditions) {
  std::vector<ParticipantRows> all;
  for (const TaskEstimateRow& row : rows) {
    if (all.empty() || all.back().participant != row.participant)
      all.push_back({row.participant, row.group, std::vector<const TaskEstimateRow*>(conditions, nullptr)});
    const TaskEstimateRow*& first = all.back().of[place(row.condition)];
    if (first == nullptr) first = &row;
  }
  return all;
}

}  // namespace jnd
