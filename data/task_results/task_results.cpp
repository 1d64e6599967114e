#include "data/task_results/task_results.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "analysis/numerics/moments.h"
#include "analysis/numerics/special_values.h"
#include "analysis/numerics/tail_probabilities.h"
#include "data/task_results/participant_tracks.h"
#include "protocols/planning/allotment.h"
#include "protocols/planning/track_threshold.h"

namespace jnd {
namespace {

std::size_t place(int index) {
  return static_cast<std::size_t>(index);
}

// Everything of one participant, condition and series, before it is turned into estimates.
struct TaskCell {
  std::vector<AnsweredTrial> trials;
  std::vector<double> response_times_s;
  double sum_s = 0;
  int excluded = 0;
};

struct ParticipantCells {
  std::string participant;
  std::optional<int> group;
  std::vector<TaskCell> cells;          // conditions x series
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
      results.counts.push_back({row.participant, row.kind, row.condition, row.series, trials[i].stimuli,
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

void add_estimates(TaskResults& results, const Protocol& protocol, const ParticipantCells& data, SessionKind kind) {
  const auto all_series = static_cast<int>(protocol.series.size());
  for (const int condition : conditions_of(protocol, data.group)) {
    for (int series = 0; series < all_series; ++series) {
      const TaskCell& cell = data.cells[place(condition * all_series + series)];
      TaskEstimateRow row;
      row.group = data.group;
      row.participant = data.participant;
      row.kind = kind;
      row.condition = condition;
      row.series = series;
      row.trials = static_cast<int>(cell.trials.size());
      row.excluded = cell.excluded;
      // A procedure's tracks end where the answers end them.
      if (!protocol.design.procedure)
        row.missing =
            std::max(0, protocol.design.sessions * trials_of_cell(protocol, series) - row.trials - row.excluded);
      if (cell.trials.empty()) {
        row.estimates = {"no_trials", std::vector<TaskEstimate>(results.outcomes.size())};
      } else {
        row.estimates = measured_estimates(protocol, protocol.series[place(series)], cell.trials,
                                           tracks_in(data.tracks, condition, series));
        row.mean_trial_s = cell.sum_s / row.trials;
        row.answers = level_counts(cell.trials, protocol);
      }
      if (!cell.response_times_s.empty()) row.median_response_time_s = median_of(cell.response_times_s);
      add_counts(results, row, cell.trials);
      results.estimates.push_back(std::move(row));
    }
  }
}

std::vector<double> values_of(const TaskResults& results, int condition, int series, std::size_t outcome) {
  std::vector<double> values;
  for (const TaskEstimateRow& row : results.estimates) {
    if (row.condition != condition || row.series != series) continue;
    const std::optional<double>& value = row.estimates.values[outcome].value;
    if (value && std::isfinite(*value)) values.push_back(*value);
  }
  return values;
}

void add_group(TaskResults& results, const Protocol& protocol, const std::vector<ParticipantCells>& all) {
  for (int condition = 0; condition < static_cast<int>(protocol.conditions.size()); ++condition) {
    const auto participants = static_cast<int>(std::count_if(all.begin(), all.end(), [&](const ParticipantCells& one) {
      return has_condition(protocol, one.group, condition);
    }));
    for (int series = 0; series < static_cast<int>(protocol.series.size()); ++series) {
      for (std::size_t outcome = 0; outcome < results.outcomes.size(); ++outcome) {
        std::vector<double> values = values_of(results, condition, series, outcome);
        const double median = values.empty() ? kNaN : median_of(values);
        results.group.push_back({condition, series, outcome, participants, mean_with_ci(values), median});
      }
    }
  }
}

// Slope of ln(outcome) on ln(standard), of a Weber fraction that of its JND; none with fewer than two different standards, or
// a value that has no logarithm.
std::optional<double> exponent_of(const TaskEstimateRow& first, const TaskResults& results, const Protocol& protocol) {
  std::vector<double> x, y;
  for (const TaskEstimateRow& row : series_from(first, protocol)) {
    const std::optional<double>& value = row.estimates.values[results.registered].value;
    const double standard = protocol.series[place(row.series)].standard;
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
  if (protocol.series.size() < 2 || !results.outcomes[results.registered].positive) return;
  for (int condition = 0; condition < static_cast<int>(protocol.conditions.size()); ++condition) {
    std::vector<double> exponents;
    for (const TaskEstimateRow& row : results.estimates) {
      if (row.condition != condition || row.series != 0) continue;
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
  const auto all_series = static_cast<int>(protocol.series.size());
  for (int condition = 0; condition < static_cast<int>(protocol.conditions.size()); ++condition) {
    for (int series = 0; series < all_series; ++series) {
      std::vector<AnsweredTrial> all;
      for (const ParticipantCells& data : participants) {
        const TaskCell& cell = data.cells[place(condition * all_series + series)];
        all.insert(all.end(), cell.trials.begin(), cell.trials.end());
      }
      if (all.empty()) continue;
      if (auto curve = task_of(protocol.task.kind).curve(protocol, protocol.series[place(series)], all))
        results.curves.push_back({condition, series, std::move(*curve)});
    }
  }
}

}  // namespace

AnsweredTrial answered(const CountedTrial& trial) {
  return {trial.asked, trial.standard, trial.target, trial.said, trial.sureness, trial.number, trial.standard_place};
}

TaskResults task_results(const Study& study, const Protocol& protocol, const std::vector<SessionInfo>& sessions,
                         const CountedTrials& trials) {
  TaskResults results;
  results.outcomes = measured_outcomes(protocol);
  for (std::size_t i = 0; i < results.outcomes.size(); ++i)
    if (results.outcomes[i].key == protocol.analysis.outcome) results.registered = i;
  std::vector<ParticipantCells> participants;
  std::vector<std::size_t> participant_of;  // session -> place in participants
  const std::size_t all_series = protocol.series.size();
  for (const SessionInfo& session : sessions) {
    if (participants.empty() || participants.back().participant != session.participant)
      participants.push_back({session.participant, group_named(protocol, session.group),
                              std::vector<TaskCell>(protocol.conditions.size() * all_series)});
    participant_of.push_back(participants.size() - 1);
  }
  trials.for_each([&](const CountedTrial& trial) {
    TaskCell& cell = participants[participant_of[place(trial.session)]]
                         .cells[place(trial.condition) * all_series + place(trial.series)];
    // An excluded answer of a procedure has moved the levels all the same.
    const std::string_view reason =
        protocol.design.procedure ? std::string_view() : exclusion_reason(protocol.analysis.exclude, trial);
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
  if (protocol.design.procedure) {
    std::span<const SessionInfo> rest = sessions;
    for (ParticipantCells& data : participants) {
      const std::span<const SessionInfo> own = sessions_of_next(rest);
      data.tracks = participant_tracks(study, protocol, own);
      rest = rest.subspan(own.size());
    }
  }
  for (const ParticipantCells& data : participants) add_estimates(results, protocol, data, kind);
  add_group(results, protocol, participants);
  add_proportion(results, protocol);
  add_curves(results, protocol, participants);
  return results;
}

std::span<const TaskEstimateRow> series_from(const TaskEstimateRow& first, const Protocol& protocol) noexcept {
  return {&first, protocol.series.size()};
}

double outcome_value(const TaskEstimateRow& first, std::size_t outcome, const Protocol& protocol, bool logarithms) {
  double sum = 0;
  for (const TaskEstimateRow& row : series_from(first, protocol)) {
    const std::optional<double>& value = row.estimates.values[outcome].value;
    if (!value || !std::isfinite(*value)) return kNaN;
    sum += logarithms ? std::log(*value) : *value;
  }
  return std::isfinite(sum) ? sum / static_cast<double>(protocol.series.size()) : kNaN;
}

double registered_value(const TaskEstimateRow& first, const TaskResults& results, const Protocol& protocol) {
  return outcome_value(first, results.registered, protocol, protocol.analysis.tests.outcome == Outcome::log_jnd);
}

}  // namespace jnd
