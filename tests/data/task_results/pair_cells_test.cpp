// Counts, delivered slopes and group rows, against sums made by hand.
#include "data/task_results/pair_cells.h"

#include <cmath>

#include "protocols/tasks/task.h"
#include "tests/catch.h"
#include "tests/data/pair_results.h"
#include "tests/data/study_fixture.h"

namespace jnd {
namespace {

// Counts, exclusions and times of a study, against sums made by hand from the plan.

std::size_t place(int index) {
  return static_cast<std::size_t>(index);
}

const CellResult& cell_of(const TaskResults& task, std::string_view participant, int condition, int series) {
  for (const CellResult& cell : task.cells)
    if (cell.participant == participant && cell.condition == condition && cell.series == series) return cell;
  throw std::out_of_range("no such cell");
}

TEST_CASE("counts are those of the answered main trials, in a cell for everything planned", "[data]") {
  const TemporaryFolder folder;
  const auto study = new_study(folder / "study.jnd", chinello());
  for (int number = 1; number <= 3; ++number) run_whole_session(*study, chinello(), number);
  const TaskResults task = estimates_in(*study, chinello());
  CHECK(task.cells.size() == 3 * 3 * 3);
  CHECK(task.estimates.size() == 3 * 3);
  CHECK(task.group.size() == 3 * task.outcomes.size());
  for (int number = 1; number <= 3; ++number) {
    std::map<std::pair<int, int>, Counts> expected;
    for (const Trial& trial : make_plan(chinello(), number, kSeed).trials) {
      if (trial.practice) continue;
      Counts& counts = expected[{trial.condition, trial.series}];
      const bool different = usual_answer(trial) == kClassDifferent;
      ((trial.target == kClassSame) ? counts.n_same : counts.n_diff) += 1;
      if (different) ((trial.target == kClassSame) ? counts.false_alarms : counts.hits) += 1;
    }
    for (const auto& [cell, counts] : expected) {
      const CellResult& found = cell_of(task, "P0" + std::to_string(number), cell.first, cell.second);
      CHECK(found.counts == counts);
      Counts halves = found.halves[0].counts;
      CHECK(halves.trials() == (counts.trials() + 1) / 2);
      halves += found.halves[1].counts;
      CHECK(halves == counts);
      CHECK(found.halves[0].sure == Counts());
      CHECK(found.missing == 0);
      CHECK(found.excluded == 0);
      CHECK(found.yes_no.dprime == yes_no(counts, Correction::loglinear).dprime);
    }
  }
  // The estimates rest on the same answers.
  for (const TaskEstimateRow& row : task.estimates) {
    int trials = 0, late = 0;
    for (const LevelCount& one : row.answers) {
      trials += one.positive + one.negative;
      late += one.second_half ? one.positive + one.negative : 0;
    }
    CHECK(trials == row.trials);
    CHECK(row.trials == 3 * 12);
    CHECK(late == row.trials / 2);
  }
  // The view that R and Python read says the same.
  SQLite::Database database((folder / "study.jnd").string(), SQLite::OPEN_READONLY);
  SQLite::Statement view(database,
                         "SELECT participant, condition, series, n_diff, hits, n_same, false_alarms FROM counts");
  int rows = 0;
  while (view.executeStep()) {
    int condition = 0, series = 0;
    while (chinello().conditions[place(condition)].name != view.getColumn(1).getString()) ++condition;
    while (chinello().series[place(series)].name != view.getColumn(2).getString()) ++series;
    const Counts counts{view.getColumn(3).getInt(), view.getColumn(4).getInt(), view.getColumn(5).getInt(),
                        view.getColumn(6).getInt()};
    CHECK(counts == cell_of(task, view.getColumn(0).getString(), condition, series).counts);
    ++rows;
  }
  CHECK(rows == 27);
}

TEST_CASE("trials that are read at every pass give what trials that are held do", "[data]") {
  const TemporaryFolder folder;
  const auto study = new_study(folder / "study.jnd", chinello());
  for (int number = 1; number <= 2; ++number) run_whole_session(*study, chinello(), number);
  const std::vector<SessionInfo> sessions = sessions_of(*study, SessionKind::simulated);
  const CountedTrials held(*study, chinello(), sessions, true), passing(*study, chinello(), sessions, false);
  REQUIRE(held.are_held());
  REQUIRE_FALSE(passing.are_held());
  std::vector<CountedTrial> passed;
  passing.for_each([&passed](const CountedTrial& trial) { passed.push_back(trial); });
  REQUIRE(passed.size() == held.held().size());
  for (std::size_t i = 0; i < passed.size(); ++i) {
    CHECK(passed[i].session == held.held()[i].session);
    CHECK(passed[i].index == held.held()[i].index);
    CHECK(passed[i].said == held.held()[i].said);
  }
  const auto results_with = [&](const CountedTrials& trials) {
    return task_results(*study, chinello(), sessions, trials, DifferenceSource::nominal);
  };
  const TaskResults first = results_with(held), second = results_with(passing);
  REQUIRE(first.cells.size() == second.cells.size());
  for (std::size_t i = 0; i < first.cells.size(); ++i) {
    CHECK(first.cells[i].counts == second.cells[i].counts);
    for (std::size_t half = 0; half < 2; ++half)
      CHECK(first.cells[i].halves[half].counts == second.cells[i].halves[half].counts);
  }
  for (std::size_t i = 0; i < first.estimates.size(); ++i) {
    CHECK(value_of(first.estimates[i], kSlope) == value_of(second.estimates[i], kSlope));
    CHECK(first.estimates[i].mean_trial_s == second.estimates[i].mean_trial_s);
  }
}

TEST_CASE("kinds are never pooled, and open sessions show what is missing", "[data]") {
  const TemporaryFolder folder;
  const auto study = new_study(folder / "study.jnd");
  run_whole_session(*study, tutorial(), 1);
  answer_all(*study->open_session(new_session(1, SessionKind::real)), tutorial(), 1, 8 + 5);  // 8 of practice
  CHECK(kinds_in(*study) == std::vector<SessionKind>{SessionKind::real, SessionKind::simulated});
  const auto sum = [](const StudyResults& results, auto member) {
    int total = 0;
    for (const CellResult& cell : results.task.cells) total += member(cell);
    return total;
  };
  const auto counted = [](const CellResult& cell) { return cell.counts.n_diff + cell.counts.n_same; };
  const auto missing = [](const CellResult& cell) { return cell.missing; };
  const StudyResults real = results_of(*study, tutorial(), SessionKind::real);
  CHECK(sum(real, counted) == 5);
  CHECK(sum(real, missing) == 11);
  CHECK(real.attendance.heads.size() == 1);
  CHECK_FALSE(real.attendance.heads[0].closed);
  const StudyResults simulated = results_of(*study, tutorial(), SessionKind::simulated);
  CHECK(sum(simulated, counted) == 16);
  CHECK(simulated.attendance.heads[0].closed);
  CHECK(simulated.attendance.heads[0].hash == study->events("P01-simulated").back().hash);
  const StudyResults pilot = results_of(*study, tutorial(), SessionKind::pilot);
  CHECK(pilot.attendance.participants == 0);
  CHECK(pilot.task.cells.empty());
  CHECK(group_of(pilot.task, 1, kJnd).participants == 0);
}

TEST_CASE("registered exclusions leave trials out, each counted once with its first reason", "[data]") {
  const TemporaryFolder folder;
  const auto study = new_study(folder / "study.jnd");
  const auto log = study->open_session(new_session(1));
  std::vector<Trial> trials = make_plan(tutorial(), 1, kSeed).trials;
  std::erase_if(trials, [](const Trial& trial) { return trial.practice; });
  for (std::size_t i = 0; i < trials.size(); ++i) {
    TrialRecord record = record_of(tutorial(), trials[i], kClassSame);
    record.answer.response_time_s = 1;
    if (i == 0) record.answer.response_time_s = 0.1;
    if (i == 1) {  // too early and saturated: one exclusion
      record.answer.response_time_s = 0.1;
      record.presentations[1].fingers[1].saturated_share = 0.9;
    }
    if (i == 2) record.answer.response_time_s = 20;
    if (i == 3) {  // an operator's time says nothing about the participant
      record.answer.response_time_s = 20;
      record.answer.entered_by = EnteredBy::operator_;
    }
    if (i == 4) record.presentations[0].fingers[0].saturated_share = 0.6;
    if (i == 5) record.presentations[0].fingers[0].saturated_share = 0.5;  // the limit itself stays in
    log->append(event_kind::kTrialCompleted, to_body(record), stamp_of(trials[i]));
  }
  Protocol protocol = tutorial();
  protocol.analysis.exclude = {0.2, 10.0, 0.5};
  const TaskResults task = estimates_in(*study, protocol);
  CHECK(task.exclusions == std::map<std::string, int>{
                               {"response_time_above", 1}, {"response_time_below", 2}, {"saturated_share_above", 1}});
  int counted = 0, excluded = 0, missing = 0;
  for (const CellResult& cell : task.cells) {
    counted += cell.counts.n_diff + cell.counts.n_same;
    excluded += cell.excluded;
    missing += cell.missing;
  }
  CHECK(counted == 12);
  CHECK(excluded == 4);
  CHECK(missing == 0);
  CHECK(estimates_in(*study, tutorial()).exclusions.empty());
}

TEST_CASE("times: the median of the participant's own entries, the mean of every trial", "[data]") {
  const TemporaryFolder folder;
  const auto study = new_study(folder / "study.jnd");
  const auto log = study->open_session(new_session(1));
  const double response_times[] = {0.4, 0.9, 0.6, 100};
  int used = 0;
  for (const Trial& trial : make_plan(tutorial(), 1, kSeed).trials) {
    if (trial.practice || trial.condition != 0 || used == 4) continue;
    TrialRecord record = record_of(tutorial(), trial, kClassSame);
    record.answer.response_time_s = response_times[used];
    if (used == 3) record.answer.entered_by = EnteredBy::operator_;
    record.duration_s = 10 + used++;
    log->append(event_kind::kTrialCompleted, to_body(record), stamp_of(trial));
  }
  const TaskResults task = estimates_in(*study, tutorial());
  CHECK(task.estimates[0].median_response_time_s == 0.6);
  CHECK(task.estimates[0].mean_trial_s.value() == Approx(11.5));
  CHECK_FALSE(task.estimates[1].median_response_time_s);
  CHECK(task.estimates[1].estimates.status == "no_information");
}

TEST_CASE("the same counts give the same results without a study; contrasts use complete pairs only", "[data]") {
  // log-linear d' of {6,6,6,1}, {6,5,6,1}, {6,4,6,2} at 400, 300, 200 N/m: JND 190.266907183593 N/m (numpy model).
  const std::vector<Counts> good = {{6, 6, 6, 1}, {6, 5, 6, 1}, {6, 4, 6, 2}};
  std::vector<CellCounts> cells;
  for (const char* participant : {"P01", "P02"})
    for (int condition = 0; condition < 3; ++condition)
      for (int series = 0; series < 3; ++series) {
        const auto& pair = chinello().series[place(series)].pair;
        const auto row = place(static_cast<int>((400 - std::abs(pair[1] - pair[0])) / 100));
        const bool all_same = std::string(participant) == "P02" && condition == 0;
        cells.push_back({participant, condition, series, all_same ? Counts{6, 0, 6, 0} : good.at(row)});
      }
  Protocol protocol = chinello();
  protocol.analysis.contrasts = {{0, 1}, {1, 2}};
  const StudyResults results = results_of(cells, protocol);
  CHECK(results.attendance.participants == 2);
  CHECK(value_of(results.task.estimates[0], kJnd) == Approx(190.266907183593).epsilon(1e-10));
  CHECK(results.task.estimates[3].estimates.status == "no_information");
  const TaskGroupRow& one_of_two = group_of(results.task, 0, kJnd);
  CHECK(one_of_two.participants == 2);
  CHECK(one_of_two.mean.n == 1);
  CHECK(one_of_two.without == std::map<std::string, int>{{"no_information", 1}});
  CHECK(group_of(results.task, 1, kJnd).mean.n == 2);
  REQUIRE(results.contrasts.size() == 4);  // on the slope, and the JND beside it
  CHECK(results.contrasts[1].outcome == "jnd");
  CHECK(results.contrasts[1].difference.n == 1);
  CHECK(results.contrasts[3].difference.n == 2);
  CHECK(results.contrasts[3].difference.mean == 0);
  CHECK_THROWS_AS(results_of_counts({{"P01", 3, 0, {}}}, protocol, SessionKind::simulated), StorageError);
}

// Slopes over the stiffness that was delivered, against sums made by hand.

std::size_t index_of(int index) {
  return static_cast<std::size_t>(index);
}

// Devices that render 0.8 of the difference asked and a little more, with a spread that is a function of the trial.
double rendered(double asked, const Trial& trial, std::size_t interval) {
  return 100 + 0.8 * asked + (interval == 0 ? 3 : -2) * (trial.index % 5);
}

// chinello's first condition cannot be fitted at all (as vibration alone), the others except in every sixth trial.
TrialRecord delivered_record(const Trial& trial) {
  TrialRecord record = record_of(chinello(), trial, usual_answer(trial));
  for (std::size_t i = 0; i < 2; ++i) {
    auto& fingers = record.presentations[i].fingers;
    const double k = rendered(trial.stimuli[i], trial, i);
    fingers[0].stiffness = k + 10;
    fingers[1].stiffness = k - 10;
    if (trial.index % 4 == 0) fingers[0].stiffness = std::nullopt, fingers[1].stiffness = k;  // one finger in contact
    if (trial.condition == 0 || (trial.index % 6 == 0 && i == 1))
      fingers[0].stiffness = fingers[1].stiffness = std::nullopt;
  }
  return record;
}

TEST_CASE("by delivered stiffness, the differences are those of the fitted slopes", "[data]") {
  const TemporaryFolder folder;
  const auto study = new_study(folder / "study.jnd", chinello());
  const std::vector<Trial> trials = make_plan(chinello(), 1, kSeed).trials;
  const auto log = study->open_session(new_session(1));
  for (const Trial& trial : trials)
    log->append(event_kind::kTrialCompleted, to_body(delivered_record(trial)), stamp_of(trial));
  const TaskResults nominal = estimates_in(*study, chinello());
  const StudyResults results =
      results_of(*study, chinello(), SessionKind::simulated, {.by = DifferenceSource::delivered});
  const TaskResults& delivered = results.task;
  CHECK(nominal.pairs.by == DifferenceSource::nominal);
  CHECK(delivered.pairs.by == DifferenceSource::delivered);
  REQUIRE(delivered.cells.size() == 9);

  std::vector<SeriesCounts> expected_series;
  for (std::size_t i = 0; i < 9; ++i) {
    const CellResult &cell = delivered.cells[i], &same_cell = nominal.cells[i];
    double sum = 0, softer = 0;
    int n = 0, without = 0, soft_intervals = 0;
    const auto& pair = chinello().series[index_of(cell.series)].pair;
    for (const Trial& trial : trials) {
      if (trial.practice || trial.condition != cell.condition || trial.series != cell.series) continue;
      const bool fit = trial.condition != 0, second = fit && trial.index % 6 != 0;
      for (std::size_t interval = 0; interval < 2; ++interval)
        if ((interval == 0 ? fit : second) && trial.stimuli[interval] == std::min(pair[0], pair[1])) {
          softer += rendered(trial.stimuli[interval], trial, interval);
          ++soft_intervals;
        }
      if ((trial.target == kClassSame)) continue;
      if (!second) {
        ++without;
        continue;
      }
      sum += std::abs(rendered(trial.stimuli[1], trial, 1) - rendered(trial.stimuli[0], trial, 0));
      ++n;
    }
    CAPTURE(i);
    CHECK(cell.delivered_difference.n == n);
    CHECK(cell.without_fit == without);
    CHECK(cell.delivered[0].n == soft_intervals);
    // What was delivered is shown whichever difference the fit uses.
    CHECK(same_cell.delivered_difference.n == n);
    CHECK(same_cell.difference == std::abs(pair[1] - pair[0]));
    CHECK(same_cell.difference_source == DifferenceSource::nominal);
    if (cell.condition == 0) {
      CHECK(n == 0);
      CHECK(std::isnan(cell.delivered_difference.mean));
      CHECK(cell.difference == std::abs(pair[1] - pair[0]));
      CHECK(cell.difference_source == DifferenceSource::nominal);
    } else {
      REQUIRE(n > 0);
      CHECK(cell.difference == Approx(sum / n).epsilon(1e-12));
      CHECK(cell.delivered[0].mean == Approx(softer / soft_intervals).epsilon(1e-12));
      CHECK(cell.difference_source == DifferenceSource::delivered);
      CHECK(cell.difference < std::abs(pair[1] - pair[0]));
    }
    if (cell.condition == 1) expected_series.push_back({sum / n, cell.counts});
  }
  // About 0.8 of the difference was delivered: the JND over it is about 0.8 of the nominal one.
  const JndEstimate expected = least_squares_jnd(expected_series, chinello().stimulus.reference, Correction::loglinear);
  const double jnd = value_of(delivered.estimates[1], kJnd);
  CHECK(jnd == Approx(expected.jnd).epsilon(1e-12));
  CHECK(jnd / value_of(nominal.estimates[1], kJnd) == Approx(0.8).margin(0.05));
  CHECK(delivered.estimates[1].difference_source == DifferenceSource::delivered);
  CHECK(value_of(delivered.estimates[0], kJnd) == value_of(nominal.estimates[0], kJnd));
  CHECK(delivered.estimates[0].difference_source == DifferenceSource::nominal);
  CHECK(group_of(delivered, 0, kJnd).difference_source == DifferenceSource::nominal);
  CHECK(group_of(delivered, 1, kJnd).difference_source == DifferenceSource::delivered);
  REQUIRE(results.contrasts.size() == 6);
  for (const ContrastRow& contrast : results.contrasts)
    CHECK(contrast.difference_source ==
          (contrast.a == 0 || contrast.b == 0 ? DifferenceSource::mixed : DifferenceSource::delivered));
}

TEST_CASE("the protocol registers which differences are used; a fit that rests on both says so", "[data]") {
  const TemporaryFolder folder;
  const auto study = new_study(folder / "study.jnd", chinello());
  const auto log = study->open_session(new_session(1));
  for (const Trial& trial : make_plan(chinello(), 1, kSeed).trials) {
    TrialRecord record = record_of(chinello(), trial, usual_answer(trial));
    if (trial.series == 2)
      for (Presentation& presentation : record.presentations)
        for (FingerPresentation& finger : presentation.fingers) finger.stiffness = std::nullopt;
    log->append(event_kind::kTrialCompleted, to_body(record), stamp_of(trial));
  }
  Protocol protocol = chinello();
  CHECK(registered_source(protocol) == DifferenceSource::nominal);
  CHECK(estimates_in(*study, protocol).estimates[0].difference_source == DifferenceSource::nominal);
  protocol.analysis.by_delivered = true;
  CHECK(registered_source(protocol) == DifferenceSource::delivered);
  const TaskResults task = results_of(*study, protocol, SessionKind::simulated).task;
  CHECK(task.pairs.by == DifferenceSource::delivered);
  CHECK(task.estimates[0].difference_source == DifferenceSource::mixed);
  CHECK(group_of(task, 0, kJnd).difference_source == DifferenceSource::mixed);
  CHECK(to_string(DifferenceSource::mixed) == "mixed");
}

TEST_CASE("excluded trials and practice are not in the delivered means", "[data]") {
  const TemporaryFolder folder;
  const auto study = new_study(folder / "study.jnd");
  const auto log = study->open_session(new_session(1));
  int counted = 0;
  for (const Trial& trial : make_plan(tutorial(), 1, kSeed).trials) {
    TrialRecord record = record_of(tutorial(), trial, kClassSame);
    const bool out = trial.practice || trial.index % 2 == 0;
    for (Presentation& presentation : record.presentations)
      for (FingerPresentation& finger : presentation.fingers) {
        finger.saturated_share = trial.index % 2 == 0 ? 0.9 : 0;
        if (out) finger.stiffness = 1e9 * presentation.duration_s;
      }
    counted += !out && (trial.target != kClassSame) ? 1 : 0;
    log->append(event_kind::kTrialCompleted, to_body(record), stamp_of(trial));
  }
  Protocol protocol = tutorial();
  protocol.analysis.exclude.saturated_share_above = 0.5;
  int found = 0;
  for (const CellResult& cell : estimates_in(*study, protocol).cells) {
    found += cell.delivered_difference.n;
    CHECK_FALSE(cell.delivered_difference.mean > 1000);
  }
  CHECK(counted > 0);
  CHECK(found == counted);
}

// The rows of the group: everyone counts, each number with its own n, and no participant is dropped silently.

JndEstimate estimate(JndStatus status, double slope) {
  JndEstimate result;
  result.status = status;
  result.slope = slope;
  result.jnd = status == JndStatus::ok ? 1 / slope : kNaN;
  result.weber = result.jnd / 900;
  result.series_used = 3;
  return result;
}

JndEstimate jnd(double value) {
  return estimate(JndStatus::ok, 1 / value);
}

const JndEstimate kWorse = estimate(JndStatus::no_sensitivity, -1e-3);
const JndEstimate kBetter = estimate(JndStatus::ceiling, kInf);
const JndEstimate kUnknown = estimate(JndStatus::no_information, kNaN);

// One condition.
TaskResults grouped(const std::vector<JndEstimate>& estimates) {
  Protocol protocol = chinello();
  protocol.conditions.resize(1);
  TaskResults results = empty_task_results(protocol);
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    TaskEstimateRow& row = results.estimates.emplace_back();
    row.participant = "P" + std::to_string(i);
    row.estimates = estimates_of(estimates[i], 900);
  }
  add_group(results, protocol);
  return results;
}

TEST_CASE("a group of JNDs counts everyone, each number with its own n", "[data]") {
  const TaskResults results = grouped({jnd(200), jnd(400), kWorse, kBetter, kUnknown});
  const TaskGroupRow &jnds = group_of(results, 0, kJnd), &slopes = group_of(results, 0, kSlope);
  CHECK(jnds.participants == 5);
  CHECK(jnds.mean.n == 2);
  CHECK(jnds.mean.mean == Approx(300));
  CHECK(group_of(results, 0, kWeber).mean.mean == Approx(1.0 / 3));
  CHECK(std::exp(jnds.logarithms.mean) == Approx(std::sqrt(200.0 * 400)));
  CHECK(jnds.median_n == 4);  // below all, 200, 400, above all
  CHECK(jnds.median == Approx(300));
  CHECK(jnds.middle == Beyond::no);
  CHECK(jnds.without == std::map<std::string, int>{{"ceiling", 1}, {"no_information", 1}, {"no_sensitivity", 1}});
  CHECK(std::isnan(jnds.inverse_mean));
  CHECK(slopes.mean.n == 3);
  CHECK(slopes.inverse_mean == Approx(3 / (1.0 / 200 + 1.0 / 400 - 1e-3)));
}

TEST_CASE("infinite medians and unusable mean slopes are said, not hidden", "[data]") {
  const TaskResults poor = grouped({kWorse, kWorse, jnd(1000)});
  CHECK(group_of(poor, 0, kJnd).median == kInf);
  CHECK(group_of(poor, 0, kJnd).middle == Beyond::above);
  CHECK(std::isnan(group_of(poor, 0, kSlope).inverse_mean));
  const TaskResults nobody = grouped({});
  const TaskGroupRow& empty = group_of(nobody, 0, kJnd);
  CHECK(empty.participants == 0);
  CHECK(empty.median_n == 0);
  CHECK(std::isnan(empty.median));
  CHECK(std::isnan(empty.mean.mean));
}

TEST_CASE("a median below what was tested is no number", "[data]") {
  // Half of the way between nothing and a JND would be the JND of no participant.
  for (const auto& estimates : {std::vector{kBetter, kBetter}, std::vector{kBetter, jnd(200)}}) {
    const TaskResults results = grouped(estimates);
    const TaskGroupRow& row = group_of(results, 0, kJnd);
    CHECK(row.median_n == 2);
    CHECK(row.middle == Beyond::below);
    CHECK(std::isnan(row.median));
  }
}

}  // namespace
}  // namespace jnd
