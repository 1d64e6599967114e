#include "data/results/study_behaviour.h"

#include <cmath>
#include <optional>

#include "analysis/group/p_adjust.h"

namespace jnd {

namespace {

std::size_t index_of(int index) {
  return static_cast<std::size_t>(index);
}

std::optional<double> difference_of(double a, double b) {
  const double difference = std::abs(a - b);
  return std::isfinite(difference) ? std::optional<double>(difference) : std::nullopt;
}

CueTrial cue_trial(const CountedTrial& trial) {
  const IntervalCues &a = trial.cues[0], &b = trial.cues[1];
  CueTrial result;
  result.said_different = trial.said_different();
  result.difference = {difference_of(a.stiffness, b.stiffness), difference_of(a.peak_force_n, b.peak_force_n),
                       difference_of(a.work_j, b.work_j), difference_of(a.dwell_s, b.dwell_s)};
  return result;
}

// Of different pairs among all trials, under both kinds of sampling: independent draws of both intervals, and balanced
// cells.
constexpr double kPlannedShare = 0.5;

BehaviourRow row_of(const std::string& participant, int condition, const std::vector<JudgedTrial>& trials) {
  return {participant, condition, order_effect(trials), response_bias(trials, kPlannedShare), drift(trials), {}, {}};
}

double fraction(std::size_t position, std::size_t of) noexcept {
  return of > 1 ? static_cast<double>(position) / static_cast<double>(of - 1) : 0;
}

// The trials of one session, each with its place among those of its cell.
std::vector<JudgedTrial> judged_in_cells(const std::vector<const CountedTrial*>& trials, std::size_t series,
                                         std::size_t cells) {
  const auto cell_of = [series](const CountedTrial& trial) {
    return index_of(trial.condition) * series + index_of(trial.series);
  };
  std::vector<std::size_t> sizes(cells), seen(cells);
  for (const CountedTrial* trial : trials) ++sizes[cell_of(*trial)];
  std::vector<JudgedTrial> judged;
  for (const CountedTrial* trial : trials) {
    JudgedTrial one;
    one.same = trial->same();
    one.first_stiffer = trial->asked[0] > trial->asked[1];
    one.said_different = trial->said_different();
    one.difference = std::abs(trial->asked[1] - trial->asked[0]);
    const std::size_t cell = cell_of(*trial);
    one.time_fraction = fraction(seen[cell]++, sizes[cell]);
    judged.push_back(one);
  }
  return judged;
}

// Which cue explains each participant's own answers best.
void count_best(CueRow& row, const std::vector<std::vector<CueTrial>>& of_participant) {
  row.best_of.assign(kCues.size(), 0);
  for (const std::vector<CueTrial>& trials : of_participant) {
    if (trials.empty()) continue;
    const std::optional<Cue> best = cue_strategy(trials).best;
    if (!best) {
      ++row.undecided;
      continue;
    }
    for (std::size_t i = 0; i < kCues.size(); ++i) row.best_of[i] += kCues[i] == *best ? 1 : 0;
  }
}

void correct_for_many(std::vector<BehaviourRow>& rows) {
  const auto correct = [&rows](double (*p_of)(const BehaviourRow&), double BehaviourHolm::*member) {
    std::vector<double> p;
    for (const BehaviourRow& row : rows) p.push_back(p_of(row));
    const std::vector<double> corrected = holm(p);
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i].holm.*member = corrected[i];
  };
  correct([](const BehaviourRow& row) { return row.order.p; }, &BehaviourHolm::order);
  correct([](const BehaviourRow& row) { return row.bias.p; }, &BehaviourHolm::bias);
  correct([](const BehaviourRow& row) { return row.drift.dprime.p; }, &BehaviourHolm::drift);
  correct([](const BehaviourRow& row) { return row.session_drift ? row.session_drift->p : kNaN; },
          &BehaviourHolm::session);
}

}  // namespace

StudyBehaviour study_behaviour(const Protocol& protocol, const std::vector<SessionInfo>& sessions,
                               const std::vector<CountedTrial>& trials) {
  // Trials of one session are in order, but sessions that ran side by side are interleaved in the file.
  std::vector<std::vector<const CountedTrial*>> by_session(sessions.size());
  for (const CountedTrial& trial : trials)
    if (exclusion_reason(protocol.analysis.exclude, trial).empty())
      by_session[index_of(trial.session)].push_back(&trial);

  const std::size_t conditions = protocol.conditions.size(), series = protocol.series.size();
  std::vector<JudgedTrial> own_trials;                                 // of the present participant
  std::vector<std::vector<JudgedTrial>> of_condition(conditions);      // of everyone
  std::vector<std::vector<JudgedTrial>> of_cell(conditions * series);  // of everyone, by place in the session
  std::vector<std::vector<std::vector<CueTrial>>> cues(conditions);    // [condition][participant]
  StudyBehaviour behaviour;
  for (std::size_t session = 0; session < sessions.size(); ++session) {
    const bool new_participant = session == 0 || sessions[session].participant != sessions[session - 1].participant;
    if (new_participant) {
      if (session > 0) behaviour.participants.push_back(row_of(sessions[session - 1].participant, -1, own_trials));
      own_trials.clear();
      for (auto& one : cues) one.emplace_back();
    }
    const std::vector<const CountedTrial*>& trials_of = by_session[session];
    const std::vector<JudgedTrial> judged = judged_in_cells(trials_of, series, conditions * series);
    own_trials.insert(own_trials.end(), judged.begin(), judged.end());
    for (std::size_t i = 0; i < judged.size(); ++i) {
      const CountedTrial& trial = *trials_of[i];
      of_condition[index_of(trial.condition)].push_back(judged[i]);
      cues[index_of(trial.condition)].back().push_back(cue_trial(trial));
      JudgedTrial in_session = judged[i];
      in_session.time_fraction = fraction(i, judged.size());
      of_cell[index_of(trial.condition) * series + index_of(trial.series)].push_back(in_session);
    }
  }
  if (!sessions.empty()) behaviour.participants.push_back(row_of(sessions.back().participant, -1, own_trials));

  for (std::size_t condition = 0; condition < conditions; ++condition) {
    behaviour.conditions.push_back(row_of("", static_cast<int>(condition), of_condition[condition]));
    std::vector<Drift> strata;
    for (std::size_t one = 0; one < series; ++one) strata.push_back(drift(of_cell[condition * series + one]));
    behaviour.conditions.back().session_drift = stratified_drift(strata);
    CueRow row;
    row.condition = static_cast<int>(condition);
    std::vector<CueTrial> all;
    for (const std::vector<CueTrial>& one : cues[condition]) all.insert(all.end(), one.begin(), one.end());
    row.strategy = cue_strategy(all);
    count_best(row, cues[condition]);
    behaviour.cues.push_back(std::move(row));
  }
  correct_for_many(behaviour.conditions);
  correct_for_many(behaviour.participants);
  return behaviour;
}

}  // namespace jnd
