#include "data/results/study_analysis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "analysis/numerics/decimal_order.h"
#include "analysis/numerics/moments.h"
#include "analysis/thresholds/jnd_bootstrap.h"
#include "data/results/threshold_method.h"
#include "data/study/trial_rows.h"
#include "protocols/planning/allotment.h"
#include "protocols/tasks/task.h"

namespace jnd {

namespace {

std::size_t place(int index) {
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
struct ParticipantData {
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
};

ParticipantData empty_data(std::string participant, std::optional<int> group, const Protocol& protocol) {
  ParticipantData data;
  data.participant = std::move(participant);
  data.group = group;
  data.cells.resize(protocol.conditions.size() * protocol.series.size());
  data.times.resize(protocol.conditions.size());
  return data;
}

void set_difference(CellResult& cell, const Delivered& delivered, const Protocol& protocol, DifferenceSource by) {
  const std::array<double, 2>& pair = protocol.series[place(cell.series)].pair;
  cell.delivered_difference = mean_of(delivered.differences, delivered.n);
  cell.without_fit = delivered.without_fit;
  for (std::size_t i = 0; i < 2; ++i) cell.delivered[i] = mean_of(delivered.stiffness[i], delivered.intervals[i]);
  const bool usable = by == DifferenceSource::delivered && delivered.n > 0;
  cell.difference_source = usable ? DifferenceSource::delivered : DifferenceSource::nominal;
  cell.difference = usable ? cell.delivered_difference.mean : plain_distance(pair[0], pair[1]);
}

DifferenceSource combined(const std::vector<DifferenceSource>& sources) {
  if (sources.empty()) return DifferenceSource::nominal;
  const bool alike =
      std::all_of(sources.begin(), sources.end(), [&](DifferenceSource one) { return one == sources.front(); });
  return alike ? sources.front() : DifferenceSource::mixed;
}

void add_contrasts(StudyAnalysis& analysis, const Protocol& protocol) {
  const auto rows = by_participant(analysis.thresholds, protocol.conditions.size());
  for (const Contrast& contrast : protocol.analysis.contrasts) {
    std::vector<double> differences;
    for (const ParticipantRows<ThresholdResult>& row : rows) {
      const ThresholdResult *a = row.of[place(contrast.a)], *b = row.of[place(contrast.b)];
      if (a == nullptr || b == nullptr) continue;
      if (a->jnd.status == JndStatus::ok && b->jnd.status == JndStatus::ok)
        differences.push_back(a->jnd.jnd - b->jnd.jnd);
    }
    analysis.contrasts.push_back({contrast.a, contrast.b, mean_with_ci(differences),
                                  combined({analysis.group[place(contrast.a)].difference_source,
                                            analysis.group[place(contrast.b)].difference_source})});
  }
}

constexpr int kReplicates = 2000;  // of the bootstrap interval of a least-squares JND

// The registered estimate. Maximum likelihood brings its profile interval; least squares has none of its own but the
// bootstrap's.
JndEstimate estimate_threshold(const std::vector<SeriesCounts>& series, const Protocol& protocol,
                               const ThresholdMethod& method, bool intervals, std::uint64_t seed) {
  JndEstimate estimate = estimate_jnd(series, protocol.stimulus.reference, method.method, method.correction);
  if (!intervals || method.method != JndMethod::least_squares || estimate.status == JndStatus::no_information)
    return estimate;
  const JndBootstrap bootstrap = least_squares_bootstrap(series, method.correction, kReplicates, seed);
  estimate.ci_low = bootstrap.ci_low;
  estimate.ci_high = bootstrap.ci_high;
  estimate.slope_ci_low = bootstrap.slope_ci_low;
  estimate.slope_ci_high = bootstrap.slope_ci_high;
  return estimate;
}

// participant_of: by session. After all trials were counted.
void add_halves(std::vector<ParticipantData>& participants, const std::vector<std::size_t>& participant_of,
                const Protocol& protocol, const CountedTrials& trials) {
  trials.for_each([&](const CountedTrial& trial) {
    if (!exclusion_reason(protocol.analysis.exclude, trial).empty()) return;
    ParticipantData::Cell& cell = participants[participant_of[place(trial.session)]]
                                      .cells[place(trial.condition) * protocol.series.size() + place(trial.series)];
    const int before = cell.halves[0].counts.trials() + cell.halves[1].counts.trials();
    HalfCounts& half = cell.halves[in_second_half(place(before), place(cell.counts.trials())) ? 1 : 0];
    half.counts.add(trial.same(), trial.said_different());
    if (is_sure(trial.sureness, protocol.task)) half.sure.add(trial.same(), trial.said_different());
  });
}

// participants: in the order of the report. seed: of the bootstrap.
void estimate(StudyAnalysis& analysis, std::vector<ParticipantData> participants, const Protocol& protocol,
              std::uint64_t seed) {
  const ThresholdMethod method = registered_method(protocol);
  const Correction rate_correction = correction_from(protocol.analysis.correction).value_or(Correction::loglinear);
  analysis.method = method;
  analysis.intervals = participants.size() <= kMostInDetail;
  const int conditions = static_cast<int>(protocol.conditions.size()),
            series = static_cast<int>(protocol.series.size());
  analysis.attendance.participants = static_cast<int>(participants.size());
  analysis.thresholds.reserve(participants.size() * place(conditions));
  analysis.cells.reserve(participants.size() * place(conditions * series));
  for (ParticipantData& data : participants) {
    for (const int condition : conditions_of(protocol, data.group)) {
      std::vector<SeriesCounts> of_series;
      std::vector<DifferenceSource> sources;  // of the series in the fit
      for (int one = 0; one < series; ++one) {
        const ParticipantData::Cell& cell = data.cells[place(condition * series + one)];
        CellResult result;
        result.participant = data.participant;
        result.kind = analysis.attendance.kind;
        result.condition = condition;
        result.series = one;
        result.counts = cell.counts;
        result.halves = cell.halves;
        result.excluded = cell.excluded;
        result.missing = cell.missing;
        result.yes_no = yes_no(cell.counts, rate_correction);
        result.group = data.group;
        set_difference(result, cell.delivered, protocol, analysis.by);
        of_series.push_back({result.difference, cell.counts});
        if (result.yes_no.status != RateStatus::missing) sources.push_back(result.difference_source);
        analysis.cells.push_back(std::move(result));
      }
      ParticipantData::Times& times = data.times[place(condition)];
      analysis.thresholds.push_back(
          {data.participant, analysis.attendance.kind, condition,
           estimate_threshold(of_series, protocol, method, analysis.intervals, seed), median_of(times.response_times_s),
           times.trials > 0 ? times.sum_s / times.trials : std::nan(""), combined(sources), data.group});
    }
    data = {};  // of many people: what estimates are made of goes as they come
  }
  for (int condition = 0; condition < conditions; ++condition) {
    std::vector<JndEstimate> estimates;
    std::vector<DifferenceSource> sources;
    for (const ThresholdResult& threshold : analysis.thresholds) {
      if (threshold.condition != condition) continue;
      estimates.push_back(threshold.jnd);
      if (threshold.jnd.series_used > 0) sources.push_back(threshold.difference_source);
    }
    analysis.group.push_back({condition, jnd_group(estimates), combined(sources)});
  }
  add_contrasts(analysis, protocol);
}

}  // namespace

std::string_view to_string(DifferenceSource source) noexcept {
  return word_of(kDifferenceSourceWords, source);
}

DifferenceSource registered_source(const Protocol& protocol) noexcept {
  return protocol.analysis.by_delivered ? DifferenceSource::delivered : DifferenceSource::nominal;
}

StudyAnalysis analyze(const Study& study, const Protocol& protocol, SessionKind kind) {
  return analyze(study, protocol, kind, registered_source(protocol));
}

std::vector<SessionInfo> sessions_of(const Study& study, SessionKind kind) {
  std::vector<SessionInfo> sessions = study.sessions();  // by participant number
  std::erase_if(sessions, [&](const SessionInfo& session) { return session.kind != kind || session.excluded; });
  return sessions;
}

std::vector<std::string> participants_of(const std::vector<SessionInfo>& sessions) {
  std::vector<std::string> participants;
  for (const SessionInfo& session : sessions)
    if (participants.empty() || participants.back() != session.participant) participants.push_back(session.participant);
  return participants;
}

std::vector<ExcludedParticipant> excluded_of(const Study& study, SessionKind kind) {
  std::vector<ExcludedParticipant> excluded = excluded_from(study);
  std::erase_if(excluded, [&](const ExcludedParticipant& one) { return one.kind != kind; });
  return excluded;
}

Attendance attendance_of(const Study& study, SessionKind kind, const std::vector<SessionInfo>& sessions) {
  Attendance attendance{kind, static_cast<int>(participants_of(sessions).size()), {}, excluded_of(study, kind)};
  for (const SessionInfo& session : sessions)
    attendance.heads.push_back(
        {session.participant, session.id, session.head, kind, session.state == "closed", session.unblinded});
  return attendance;
}

StudyAnalysis analyze(const Study& study, const Protocol& protocol, SessionKind kind, DifferenceSource by) {
  const std::vector<SessionInfo> sessions = sessions_of(study, kind);
  return analyze(study, protocol, kind, by, sessions, CountedTrials(study, protocol, sessions, false));
}

StudyAnalysis analyze(const Study& study, const Protocol& protocol, SessionKind kind, DifferenceSource by,
                      const std::vector<SessionInfo>& sessions, const CountedTrials& trials) {
  StudyAnalysis analysis;
  analysis.attendance = attendance_of(study, kind, sessions);
  analysis.by = by;
  std::vector<ParticipantData> participants;
  std::vector<std::size_t> participant_of;  // session -> place in participants
  for (const SessionInfo& session : sessions) {
    if (participants.empty() || participants.back().participant != session.participant)
      participants.push_back(empty_data(session.participant, group_named(protocol, session.group), protocol));
    participant_of.push_back(participants.size() - 1);
  }

  const std::size_t series = protocol.series.size();
  trials.for_each([&](const CountedTrial& trial) {
    ParticipantData& data = participants[participant_of[place(trial.session)]];
    ParticipantData::Cell& cell = data.cells[place(trial.condition) * series + place(trial.series)];
    const std::string_view reason = exclusion_reason(protocol.analysis.exclude, trial);
    if (!reason.empty()) {
      ++cell.excluded;
      ++analysis.exclusions[std::string(reason)];
      return;
    }
    cell.counts.add(trial.same(), trial.said_different());
    cell.delivered.add(trial, protocol.series[place(trial.series)].pair);
    ParticipantData::Times& times = data.times[place(trial.condition)];
    times.sum_s += trial.duration_s;
    ++times.trials;
    if (trial.by_participant) times.response_times_s.push_back(trial.response_time_s);
  });
  const bool told_apart = participants.size() <= kMostInDetail;
  if (told_apart) add_halves(participants, participant_of, protocol, trials);
  for (ParticipantData& data : participants)
    for (ParticipantData::Cell& cell : data.cells) {
      if (!told_apart) cell.halves[0].counts = cell.counts;
      cell.missing = std::max(0, protocol.design.sessions * protocol.design.trials_per_cell - cell.counts.n_diff -
                                     cell.counts.n_same - cell.excluded);
    }
  estimate(analysis, std::move(participants), protocol, study.info().seed);
  return analysis;
}

std::vector<SessionKind> kinds_in(const Study& study) {
  std::vector<SessionKind> kinds;
  for (const SessionInfo& session : study.sessions())
    if (!session.excluded && (kinds.empty() || kinds.back() != session.kind)) kinds.push_back(session.kind);
  return kinds;
}

StudyAnalysis analyze_counts(const std::vector<CellCounts>& cells, const Protocol& protocol, SessionKind kind) {
  StudyAnalysis analysis;
  analysis.attendance.kind = kind;
  std::map<std::string, std::size_t> places;
  std::vector<ParticipantData> participants;  // in the order of their first cell
  for (const CellCounts& cell : cells) {
    if (cell.condition < 0 || cell.condition >= static_cast<int>(protocol.conditions.size()) || cell.series < 0 ||
        cell.series >= static_cast<int>(protocol.series.size()))
      throw StorageError(fmt::format("participant {}: condition {} or series {} is not in protocol {}",
                                     cell.participant, cell.condition, cell.series, protocol.name));
    const auto [found, is_new] = places.try_emplace(cell.participant, participants.size());
    if (is_new) participants.push_back(empty_data(cell.participant, cell.group, protocol));
    ParticipantData::Cell& of =
        participants[found->second].cells[place(cell.condition) * protocol.series.size() + place(cell.series)];
    of.counts += cell.counts;
    of.halves[0].counts = of.counts;
  }
  estimate(analysis, std::move(participants), protocol, 1);
  return analysis;
}

}  // namespace jnd
