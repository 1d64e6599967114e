// Slopes over the stiffness that was delivered, against sums made by hand.
#include <cmath>

#include "data/results/study_analysis.h"
#include "protocols/tasks/same_different_task.h"
#include "tests/catch.h"
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
  const StudyAnalysis nominal = analyze(*study, chinello(), SessionKind::simulated);
  const StudyAnalysis delivered = analyze(*study, chinello(), SessionKind::simulated, DifferenceSource::delivered);
  CHECK(nominal.by == DifferenceSource::nominal);
  CHECK(delivered.by == DifferenceSource::delivered);
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
  CHECK(delivered.thresholds[1].jnd.jnd == Approx(expected.jnd).epsilon(1e-12));
  CHECK(delivered.thresholds[1].jnd.jnd / nominal.thresholds[1].jnd.jnd == Approx(0.8).margin(0.05));
  CHECK(delivered.thresholds[1].difference_source == DifferenceSource::delivered);
  CHECK(delivered.thresholds[0].jnd.jnd == nominal.thresholds[0].jnd.jnd);
  CHECK(delivered.thresholds[0].difference_source == DifferenceSource::nominal);
  CHECK(delivered.group[0].difference_source == DifferenceSource::nominal);
  CHECK(delivered.group[1].difference_source == DifferenceSource::delivered);
  for (const ContrastResult& contrast : delivered.contrasts)
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
  CHECK(analyze(*study, protocol, SessionKind::simulated).thresholds[0].difference_source == DifferenceSource::nominal);
  protocol.analysis.by_delivered = true;
  CHECK(registered_source(protocol) == DifferenceSource::delivered);
  const StudyAnalysis analysis = analyze(*study, protocol, SessionKind::simulated);
  CHECK(analysis.by == DifferenceSource::delivered);
  CHECK(analysis.thresholds[0].difference_source == DifferenceSource::mixed);
  CHECK(analysis.group[0].difference_source == DifferenceSource::mixed);
  CHECK(analyze(*study, protocol, SessionKind::simulated, DifferenceSource::nominal).by == DifferenceSource::nominal);
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
  for (const CellResult& cell : analyze(*study, protocol, SessionKind::simulated).cells) {
    found += cell.delivered_difference.n;
    CHECK_FALSE(cell.delivered_difference.mean > 1000);
  }
  CHECK(counted > 0);
  CHECK(found == counted);
}

}  // namespace
}  // namespace jnd
