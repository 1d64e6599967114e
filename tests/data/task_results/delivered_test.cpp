// Slopes over the stiffness that was delivered, against sums made by hand.
#include <cmath>

#include "protocols/tasks/task.h"
#include "tests/catch.h"
#include "tests/data/pair_results.h"
#include "tests/data/study_fixture.h"

namespace jnd {
namespace {

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

}  // namespace
}  // namespace jnd
