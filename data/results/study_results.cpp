#include "data/results/study_results.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "analysis/group/p_adjust.h"
#include "analysis/numerics/special_values.h"
#include "data/log/replay.h"
#include "data/results/rating_answers.h"
#include "data/results/study_cautions.h"
#include "data/study/blinding.h"
#include "protocols/course/prescription.h"
#include "protocols/delivery.h"
#include "protocols/planning/allotment.h"

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

// trials: those of read_counted_trials for these sessions.
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

// The same cells under another method.
TaskResults results_under(const TaskResults& results, const Protocol& protocol, const ThresholdMethod& method) {
  TaskResults other = empty_task_results(protocol);
  for (std::size_t row = 0; row < results.estimates.size(); ++row) {
    const TaskEstimateRow& of = results.estimates[row];
    TaskEstimateRow& one = other.estimates.emplace_back();
    one.participant = of.participant;
    one.condition = of.condition;
    one.group = of.group;
    one.estimates = estimates_of(
        estimate_jnd(series_of(results, protocol, row), protocol.stimulus.reference, method.method, method.correction),
        protocol.stimulus.reference);
  }
  add_group(other, protocol);
  return other;
}

SensitivityRow row_of(TaskResults results, const Protocol& protocol, const ThresholdMethod& method) {
  SensitivityRow row;
  row.method = method;
  const std::size_t conditions = protocol.conditions.size();
  row.participants = static_cast<int>(by_participant(results.estimates, conditions).size());
  const OutcomeComparison outcome = compare_task(results, protocol);
  for (TaskGroupRow& of : results.group)
    if (results.outcomes[of.outcome].key == "jnd") row.group.push_back(std::move(of));
  row.n = static_cast<int>(outcome.table.n);
  row.refused = outcome.refused;
  const bool tested = outcome.refused.empty();
  row.omnibus_p = tested ? omnibus_p(outcome.comparison, protocol.analysis) : kNaN;
  if (!outcome.crossed) {
    for (const ContrastWithin& contrast : contrasts_within(outcome, protocol)) {
      row.contrast_p.push_back(contrast.p);
      row.contrast_slope.push_back(contrast.refused.empty() ? mean_with_ci(contrast.differences).mean : kNaN);
    }
    return row;
  }
  row.contrast_p = tested ? contrast_p(outcome.comparison, protocol.analysis)
                          : std::vector<double>(protocol.analysis.contrasts.size(), kNaN);
  for (const Contrast& contrast : protocol.analysis.contrasts) {
    if (!tested) {
      row.contrast_slope.push_back(kNaN);
      continue;
    }
    const PairPlace place = pair_of(contrast, conditions);
    const double difference = outcome.comparison.pairs[place.pair].mean_difference;
    row.contrast_slope.push_back(place.turned ? -difference : difference);
  }
  return row;
}

bool significant(double p, double alpha) noexcept {
  return p <= alpha;  // false for an undefined p
}

bool decides_alike(const SensitivityRow& row, const SensitivityRow& registered, double alpha) {
  if (!row.refused.empty() || !registered.refused.empty()) return false;
  if (significant(row.omnibus_p, alpha) != significant(registered.omnibus_p, alpha)) return false;
  for (std::size_t i = 0; i < row.contrast_p.size(); ++i) {
    if (significant(row.contrast_p[i], alpha) != significant(registered.contrast_p[i], alpha)) return false;
    if (significant(row.contrast_p[i], alpha) &&
        std::signbit(row.contrast_slope[i]) != std::signbit(registered.contrast_slope[i]))
      return false;
  }
  return true;
}

// Of pairs at given levels; the registered method first. Tests run on what the plan registers (slope, JND or its logarithm).
std::vector<SensitivityRow> study_sensitivity(const TaskResults& results, const Protocol& protocol) {
  std::vector<SensitivityRow> rows;
  for (const ThresholdMethod& method : all_methods(registered_method(protocol))) {
    rows.push_back(row_of(results_under(results, protocol, method), protocol, method));
    rows.back().registered = rows.size() == 1;
    rows.back().same_conclusion = decides_alike(rows.back(), rows.front(), protocol.analysis.tests.alpha);
  }
  return rows;
}

// Of an answer among the ordered categories, from "same" with the greatest sureness to "different" with it.
std::size_t category_of(const CountedTrial& trial, int degrees) {
  const int sureness = std::clamp(trial.sureness, 1, degrees);
  return static_cast<std::size_t>(trial.said_different() ? degrees + sureness - 1 : degrees - sureness);
}

// trials: those of read_counted_trials for these sessions. Empty where the protocol does not ask how sure one is. By
// participant, then condition, of those with a trial.
std::vector<SurenessRow> study_sureness(const Protocol& protocol, const std::vector<SessionInfo>& sessions,
                                        const std::vector<CountedTrial>& trials) {
  const int degrees = protocol.task.sureness_levels;
  if (degrees == 0) return {};
  using Levels = std::map<double, std::vector<int>>;
  std::map<std::pair<std::string, int>, Levels> cells;
  for (const CountedTrial& trial : trials) {
    if (!exclusion_reason(protocol.analysis.exclude, trial).empty()) continue;
    const std::string& participant = sessions[static_cast<std::size_t>(trial.session)].participant;
    const double delta = trial.same() ? 0 : std::abs(trial.asked[0] - trial.asked[1]);
    std::vector<int>& counts = cells[{participant, trial.condition}][delta];
    counts.resize(2 * static_cast<std::size_t>(degrees));
    ++counts[category_of(trial, degrees)];
  }
  std::vector<SurenessRow> rows;
  for (const auto& [place, of] : cells) {
    SurenessRow row{place.first, place.second, 0, {}};
    std::vector<SurenessLevel> levels;
    for (const auto& [delta, counts] : of) {
      levels.push_back({delta, counts});
      for (const int count : counts) row.trials += count;
    }
    row.fit = sureness(levels);
    rows.push_back(std::move(row));
  }
  return rows;
}

void add_ratings(StudyResults& results, const Study& study, const Protocol& protocol,
                 const std::vector<SessionInfo>& sessions) {
  const std::vector<std::string> participants = participants_of(sessions);
  std::vector<std::optional<int>> groups;
  for (std::size_t i = 0; i < sessions.size(); ++i)
    if (i == 0 || sessions[i].participant != sessions[i - 1].participant)
      groups.push_back(group_named(protocol, sessions[i].group));
  const std::vector<RatedQuestion> ratings = read_ratings(study, protocol, sessions);
  for (const RatedQuestion& rated : ratings)
    if (rated.paired) results.comparisons.push_back(compare_ratings(rated, participants, protocol, groups));
  results.questionnaire = questionnaire_of(ratings, participants.size(), protocol);
}

// What follows from the estimates alone.
void add_tests(StudyResults& results, const Protocol& protocol, bool times) {
  const TaskResults& task = results.task;
  if (task.outcomes.empty()) return;
  OutcomeComparison registered = compare_task(task, protocol);
  registered.registered = true;
  if (!protocol.groups.empty()) results.groups = compare_groups(registered, protocol);
  results.comparisons.push_back(std::move(registered));
  if (times) results.comparisons.push_back(compare_times(task, protocol));
  results.detailed = static_cast<std::size_t>(results.attendance.participants) <= kMostInDetail;
  if (task.cells.empty()) return;
  results.by_series = compare_series(task.cells, protocol);
  if (results.detailed) results.sensitivity = study_sensitivity(task, protocol);
  if (results.detailed) results.combinations = cue_combinations(task, protocol);
}

void add_model_and_contrasts(StudyResults& results, const Protocol& protocol, bool hierarchical) {
  const OutcomeComparison* const registered = results.registered();
  if (registered == nullptr) return;
  if ((hierarchical || protocol.analysis.hierarchical) &&
      (!results.task.cells.empty() || task_of(protocol.task.kind).answer_model(protocol)))
    results.hierarchical = study_hierarchical(results.task, protocol);
  results.contrasts =
      contrast_rows(results.task, *registered, results.hierarchical ? &*results.hierarchical : nullptr, protocol);
}

// Of a rig of the laboratory's own, which says itself what it delivered; empty: as asked, or it measures nothing.
std::string delivery_caution(const Study& study, const Protocol& protocol, SessionKind kind) {
  if (protocol.rig.device != kExternalRig || kind == SessionKind::simulated) return {};
  Deliveries all;
  for (const SessionInfo& session : sessions_of(study, kind)) {
    const Deliveries its = deliveries_of(replay(study.events(session.id)).completed, protocol);
    all.measured += its.measured;
    all.off += its.off;
  }
  if (all.off == 0) return {};
  return fmt::format(
      "By its own measure the rig did not deliver what was asked in {} of {} intervals (more than {:.0f} % off): what was "
      "felt there is not what these numbers assume.",
      all.off, all.measured, 100 * kDeliveryTolerance);
}

// Numbers of every kind of session are allotted to the same groups: where people's are sealed, so are all. Of few
// participants the numbers of a group tell who is in it.
void forget_groups(StudyResults& results) {
  results.groups.reset();
  const auto forget = [](auto& rows) {
    for (auto& row : rows) row.group.reset();
  };
  forget(results.task.cells);
  forget(results.task.counts);
  forget(results.task.estimates);
  forget(results.task.tracks);
  for (OutcomeComparison& outcome : results.comparisons) forget(outcome.everyone);
  if (results.hierarchical) forget(results.hierarchical->people);
}

}  // namespace

StudyResults results_of(const Study& study, const Protocol& protocol, SessionKind kind, const ResultsAsked& asked) {
  ChainReport chains = require_whole_chains(study);
  StudyResults results;
  const std::vector<SessionInfo> sessions = sessions_of(study, kind);
  results.attendance = attendance_of(study, kind, sessions);
  // Held of as many people as are shown one by one.
  const CountedTrials trials(study, protocol, sessions,
                             static_cast<std::size_t>(results.attendance.participants) <= kMostInDetail);
  results.task = task_results(study, protocol, sessions, trials, asked.by);
  add_tests(results, protocol, true);
  add_ratings(results, study, protocol, sessions);
  results.exploration = exploration_results(study, protocol, sessions);
  if (trials.are_held() && !results.task.outcomes.empty())
    results.answers = answer_raster(protocol, sessions, trials.held());
  if (trials.are_held() && !results.task.cells.empty()) {
    results.behaviour = study_behaviour(protocol, sessions, trials.held());
    results.sureness = study_sureness(protocol, sessions, trials.held());
  }
  if (judges_exploration(protocol))
    trials.for_each([&](const CountedTrial& trial) { results.off_prescription += trial.off_prescription ? 1 : 0; });
  add_model_and_contrasts(results, protocol, asked.hierarchical);
  const bool sealed = plan_sealed(study, protocol);
  const bool forgotten = sealed && results.groups && protocol.allotment == Allotment::balanced;
  if (forgotten) forget_groups(results);
  results.deviations = deviations_of(results, protocol);
  results.cautions = cautions_of(results, protocol);
  if (forgotten)
    results.cautions.emplace_back(
        "Groups are not compared while the study is blinded: who is in which group is sealed.");
  if (const std::string words = delivery_caution(study, protocol, kind); !words.empty())
    results.cautions.insert(results.cautions.begin(), words);
  if (sealed) results.answers.clear();  // trial by trial they are the plan that people are to have
  for (SessionHead& head : results.attendance.heads)
    if (sealed && !head.closed) head.hash.clear();  // as shown_head()
  results.chains = std::move(chains);
  return results;
}

StudyResults results_of(const Study& study, const Protocol& protocol, SessionKind kind) {
  return results_of(study, protocol, kind, {.by = registered_source(protocol)});
}

StudyResults results_of(TaskResults task, int participants, const Protocol& protocol, bool hierarchical) {
  StudyResults results;
  results.attendance.participants = participants;
  results.task = std::move(task);
  add_tests(results, protocol, false);
  add_model_and_contrasts(results, protocol, hierarchical);
  results.deviations = deviations_of(results, protocol);
  results.cautions = cautions_of(results, protocol);
  return results;
}

}  // namespace jnd
