#include "data/task_results/pair_cells.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "analysis/numerics/decimal_order.h"
#include "analysis/numerics/moments.h"
#include "analysis/thresholds/jnd_bootstrap.h"
#include "data/log/storage_error.h"
#include "data/task_results/task_results.h"
#include "protocols/planning/allotment.h"

namespace jnd {

namespace {

std::size_t at(int index) {
  return static_cast<std::size_t>(index);
}

// Sums over the counted trials of a cell.
struct Delivered {
  double differences = 0;  // of |k2 - k1|
  int n = 0, without_fit = 0;
  std::array<double, 2> stiffness{};  // by nominal stiffness: the softer, the stiffer
  std::array<int, 2> intervals{};

  void add(const CountedTrial& trial, const std::array<double, 2>& pair) noexcept {
    const double middle = 0.5 * (pair[0] + pair[1]);
    for (std::size_t i = 0; i < 2; ++i) {
      const std::optional<double> delivered = trial.delivered(i);
      if (!delivered) continue;
      const std::size_t place = trial.asked[i] > middle ? 1 : 0;
      stiffness[place] += *delivered;
      ++intervals[place];
    }
    if (trial.same()) return;
    if (trial.delivered(0) && trial.delivered(1)) {
      differences += std::abs(*trial.delivered(1) - *trial.delivered(0));
      ++n;
    } else {
      ++without_fit;
    }
  }
};

DeliveredMean mean_of(double sum, int n) noexcept {
  return n > 0 ? DeliveredMean{sum / n, n} : DeliveredMean{};
}

// Everything of one participant, before it is turned into estimates.
struct PersonData {
  struct Cell {
    Counts counts;
    std::array<HalfCounts, 2> halves{};
    int excluded = 0;
    int missing = 0;
    Delivered delivered;
  };
  struct Times {
    std::vector<double> response_times_s;
    double sum_s = 0;
    int trials = 0;
  };
  std::string participant;
  std::optional<int> group;
  std::vector<Cell> cells;   // conditions x series
  std::vector<Times> times;  // conditions

  PersonData(std::string who, std::optional<int> of, const Protocol& protocol)
      : participant(std::move(who)),
        group(of),
        cells(protocol.conditions.size() * protocol.series.size()),
        times(protocol.conditions.size()) {}
};

void set_difference(CellResult& cell, const Delivered& delivered, const Protocol& protocol, DifferenceSource by) {
  const std::array<double, 2>& pair = protocol.series[at(cell.series)].pair;
  cell.delivered_difference = mean_of(delivered.differences, delivered.n);
  cell.without_fit = delivered.without_fit;
  for (std::size_t i = 0; i < 2; ++i) cell.delivered[i] = mean_of(delivered.stiffness[i], delivered.intervals[i]);
  const bool usable = by == DifferenceSource::delivered && delivered.n > 0;
  cell.difference_source = usable ? DifferenceSource::delivered : DifferenceSource::nominal;
  cell.difference = usable ? cell.delivered_difference.mean : plain_distance(pair[0], pair[1]);
}

constexpr int kReplicates = 2000;  // of the bootstrap interval of a least-squares JND

// The registered estimate. Maximum likelihood brings its profile interval; least squares has none of its own but the
// bootstrap's.
JndEstimate estimate_pairs(const std::vector<SeriesCounts>& series, const Protocol& protocol, const PairMethod& of,
                           std::uint64_t seed) {
  const ThresholdMethod& method = of.method;
  JndEstimate estimate = estimate_jnd(series, protocol.stimulus.reference, method.method, method.correction);
  if (!of.intervals || method.method != JndMethod::least_squares || estimate.status == JndStatus::no_information)
    return estimate;
  const JndBootstrap bootstrap = least_squares_bootstrap(series, method.correction, kReplicates, seed);
  estimate.ci_low = bootstrap.ci_low;
  estimate.ci_high = bootstrap.ci_high;
  estimate.slope_ci_low = bootstrap.slope_ci_low;
  estimate.slope_ci_high = bootstrap.slope_ci_high;
  return estimate;
}

// level: of trials with different stimuli; same_level: of the others.
void add_level_counts(std::vector<LevelCount>& answers, const CellResult& cell, double level, double same_level) {
  for (const bool second_half : {false, true}) {
    const auto& [counts, sure] = cell.halves[second_half ? 1 : 0];
    if (counts.n_diff > 0)
      answers.push_back(
          {level, counts.hits, counts.n_diff - counts.hits, second_half, sure.hits, sure.n_diff - sure.hits});
    if (counts.n_same > 0)
      answers.push_back({same_level, counts.false_alarms, counts.n_same - counts.false_alarms, second_half,
                         sure.false_alarms, sure.n_same - sure.false_alarms});
  }
}

// participant_of: by session. After all trials were counted.
void add_halves(std::vector<PersonData>& people, const std::vector<std::size_t>& participant_of,
                const Protocol& protocol, const CountedTrials& trials) {
  trials.for_each([&](const CountedTrial& trial) {
    if (!exclusion_reason(protocol.analysis.exclude, trial).empty()) return;
    PersonData::Cell& cell = people[participant_of[at(trial.session)]]
                                 .cells[at(trial.condition) * protocol.series.size() + at(trial.series)];
    const int before = cell.halves[0].counts.trials() + cell.halves[1].counts.trials();
    HalfCounts& half = cell.halves[in_second_half(at(before), at(cell.counts.trials())) ? 1 : 0];
    half.counts.add(trial.same(), trial.said_different());
    if (is_sure(trial.sureness, protocol.task)) half.sure.add(trial.same(), trial.said_different());
  });
}

std::optional<double> known(double value) {
  return std::isnan(value) ? std::nullopt : std::optional(value);
}

// The cells of a participant in a condition, and the estimates from them.
void add_condition(TaskResults& results, const PersonData& data, int condition, const Protocol& protocol,
                   SessionKind kind, std::uint64_t seed) {
  const Correction correction = correction_from(protocol.analysis.correction).value_or(Correction::loglinear);
  const AnswerModel observer = task_of(protocol.task.kind).answer_model(protocol).value_or(AnswerModel());
  TaskEstimateRow row;
  row.participant = data.participant;
  row.group = data.group;
  row.kind = kind;
  row.condition = condition;
  std::vector<SeriesCounts> of_series;
  std::vector<DifferenceSource> sources;  // of the series in the fit
  for (int one = 0; one < static_cast<int>(protocol.series.size()); ++one) {
    const PersonData::Cell& cell = data.cells[at(condition) * protocol.series.size() + at(one)];
    CellResult& result = results.cells.emplace_back();
    result.participant = data.participant;
    result.kind = kind;
    result.condition = condition;
    result.series = one;
    result.counts = cell.counts;
    result.halves = cell.halves;
    result.excluded = cell.excluded;
    result.missing = cell.missing;
    result.yes_no = yes_no(cell.counts, correction);
    result.group = data.group;
    set_difference(result, cell.delivered, protocol, results.pairs.by);
    of_series.push_back({result.difference, cell.counts});
    if (result.yes_no.status != RateStatus::missing) sources.push_back(result.difference_source);
    row.trials += cell.counts.trials();
    row.excluded += cell.excluded;
    row.missing += cell.missing;
    add_level_counts(row.answers, result, result.difference, observer.level_of_equal(result.difference));
  }
  row.difference_source = combined(sources);
  row.estimates = estimates_of(estimate_pairs(of_series, protocol, results.pairs, seed), protocol.stimulus.reference);
  const PersonData::Times& times = data.times[at(condition)];
  if (!times.response_times_s.empty()) row.median_response_time_s = median_of(times.response_times_s);
  if (times.trials > 0) row.mean_trial_s = times.sum_s / times.trials;
  results.estimates.push_back(std::move(row));
}

// people: in the order of the report.
void add_people(TaskResults& results, std::vector<PersonData> people, const Protocol& protocol, SessionKind kind,
                std::uint64_t seed) {
  results.pairs.method = registered_method(protocol);
  results.pairs.intervals = people.size() <= kMostInDetail;
  results.estimates.reserve(people.size() * protocol.conditions.size());
  results.cells.reserve(results.estimates.capacity() * protocol.series.size());
  for (PersonData& data : people) {
    for (const int condition : conditions_of(protocol, data.group))
      add_condition(results, data, condition, protocol, kind, seed);
    data.cells = {};  // of many people: what estimates are made of goes as they come
    data.times = {};
  }
}

}  // namespace

std::string_view to_string(DifferenceSource source) noexcept {
  return word_of(kDifferenceSourceWords, source);
}

DifferenceSource registered_source(const Protocol& protocol) noexcept {
  return protocol.analysis.by_delivered ? DifferenceSource::delivered : DifferenceSource::nominal;
}

DifferenceSource combined(const std::vector<DifferenceSource>& sources) noexcept {
  if (sources.empty()) return DifferenceSource::nominal;
  const bool alike =
      std::all_of(sources.begin(), sources.end(), [&](DifferenceSource one) { return one == sources.front(); });
  return alike ? sources.front() : DifferenceSource::mixed;
}

void add_pairs(TaskResults& results, const Protocol& protocol, const std::vector<SessionInfo>& sessions,
               const CountedTrials& trials, DifferenceSource by, std::uint64_t seed) {
  results.pairs.by = by;
  std::vector<PersonData> people;
  std::vector<std::size_t> participant_of;  // session -> place in people
  for (const SessionInfo& session : sessions) {
    if (people.empty() || people.back().participant != session.participant)
      people.emplace_back(session.participant, group_named(protocol, session.group), protocol);
    participant_of.push_back(people.size() - 1);
  }
  trials.for_each([&](const CountedTrial& trial) {
    PersonData& data = people[participant_of[at(trial.session)]];
    PersonData::Cell& cell = data.cells[at(trial.condition) * protocol.series.size() + at(trial.series)];
    const std::string_view reason = exclusion_reason(protocol.analysis.exclude, trial);
    if (!reason.empty()) {
      ++cell.excluded;
      ++results.exclusions[std::string(reason)];
      return;
    }
    cell.counts.add(trial.same(), trial.said_different());
    cell.delivered.add(trial, protocol.series[at(trial.series)].pair);
    PersonData::Times& times = data.times[at(trial.condition)];
    times.sum_s += trial.duration_s;
    ++times.trials;
    if (trial.by_participant) times.response_times_s.push_back(trial.response_time_s);
  });
  const bool told_apart = people.size() <= kMostInDetail;
  if (told_apart) add_halves(people, participant_of, protocol, trials);
  for (PersonData& data : people)
    for (PersonData::Cell& cell : data.cells) {
      if (!told_apart) cell.halves[0].counts = cell.counts;
      cell.missing = std::max(
          0, protocol.design.sessions * protocol.design.trials_per_cell - cell.counts.trials() - cell.excluded);
    }
  const SessionKind kind = sessions.empty() ? SessionKind::simulated : sessions.front().kind;
  add_people(results, std::move(people), protocol, kind, seed);
}

TaskResults results_of_counts(const std::vector<CellCounts>& cells, const Protocol& protocol, SessionKind kind) {
  TaskResults results = empty_task_results(protocol);
  std::map<std::string, std::size_t> places;
  std::vector<PersonData> people;  // in the order of their first cell
  for (const CellCounts& cell : cells) {
    if (cell.condition < 0 || at(cell.condition) >= protocol.conditions.size() || cell.series < 0 ||
        at(cell.series) >= protocol.series.size())
      throw StorageError(fmt::format("participant {}: condition {} or series {} is not in protocol {}",
                                     cell.participant, cell.condition, cell.series, protocol.name));
    const auto [found, is_new] = places.try_emplace(cell.participant, people.size());
    if (is_new) people.emplace_back(cell.participant, cell.group, protocol);
    PersonData::Cell& of = people[found->second].cells[at(cell.condition) * protocol.series.size() + at(cell.series)];
    of.counts += cell.counts;
    of.halves[0].counts = of.counts;
  }
  add_people(results, std::move(people), protocol, kind, 1);
  add_group(results, protocol);
  return results;
}

std::vector<SeriesCounts> series_of(const TaskResults& results, const Protocol& protocol, std::size_t row) {
  const std::size_t series = protocol.series.size();
  std::vector<SeriesCounts> counts;
  for (std::size_t i = row * series; i < (row + 1) * series; ++i)
    counts.push_back({results.cells[i].difference, results.cells[i].counts});
  return counts;
}

TaskEstimates estimates_of(const JndEstimate& estimate, double reference) {
  const bool ok = estimate.status == JndStatus::ok;
  const Beyond beyond = estimate.status == JndStatus::no_sensitivity ? Beyond::above
                        : estimate.status == JndStatus::ceiling      ? Beyond::below
                                                                     : Beyond::no;
  TaskEstimates estimates;
  estimates.status = to_string(estimate.status);
  estimates.values = {
      {known(estimate.slope), known(estimate.slope_ci_low), known(estimate.slope_ci_high)},
      {ok ? known(estimate.jnd) : std::nullopt, known(estimate.ci_low), known(estimate.ci_high), 0, beyond},
      {ok ? known(estimate.weber) : std::nullopt, known(estimate.ci_low / reference),
       known(estimate.ci_high / reference), 0, beyond}};
  for (const Caution caution : estimate.cautions) estimates.cautions.emplace_back(to_string(caution));
  estimates.series_used = estimate.series_used;
  return estimates;
}

}  // namespace jnd
