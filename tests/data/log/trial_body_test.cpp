// The one-pass reader of answered trials against the records that were written.
#include "data/log/trial_body.h"

#include <cmath>

#include "data/log/event_body.h"
#include "data/log/storage_error.h"
#include "protocols/tasks/task.h"
#include "tests/catch.h"
#include "tests/data/study_fixture.h"

namespace jnd {
namespace {

TEST_CASE("a trial is read back from its body as it was written", "[data]") {
  const Plan plan = make_plan(tutorial(), 3, kSeed);
  TrialBodyReader reader(tutorial().stimulus.unit);
  for (const Trial& trial : plan.trials) {
    const int answer = trial.index % 3 == 0 ? kClassSame : kClassDifferent;
    TrialRecord record = record_of(tutorial(), trial, answer);
    record.answer.entered_by = trial.index % 2 == 0 ? EnteredBy::participant : EnteredBy::operator_;
    const CountedTrial read = reader.read(body_text(to_body(record)));
    CHECK(read.index == trial.index);
    CHECK(read.practice == trial.practice);
    CHECK(read.series == trial.series);
    CHECK(read.condition == trial.condition);
    CHECK(read.same() == (trial.target == kClassSame));
    CHECK(read.said_different() == (answer == kClassDifferent));
    CHECK(read.by_participant == (trial.index % 2 == 0));
    CHECK(read.response_time_s == record.answer.response_time_s);
    CHECK(read.duration_s == record.duration_s);
    CHECK(read.saturated_share == largest_saturated_share(record));
    CHECK(read.asked == trial.stimuli);
    for (std::size_t i = 0; i < 2; ++i) {
      double stiffness = 0, work = 0, peak = 0;
      int fits = 0;
      for (const FingerPresentation& finger : record.presentations[i].fingers) {
        if (finger.stiffness) stiffness += *finger.stiffness;
        fits += finger.stiffness ? 1 : 0;
        work += finger.work_j;
        peak = std::max(peak, finger.peak_force_n);
      }
      const auto fingers = static_cast<double>(record.presentations[i].fingers.size());
      CHECK(read.delivered(i).has_value() == (fits > 0));
      if (fits > 0) CHECK(*read.delivered(i) == Approx(stiffness / fits).epsilon(1e-15));
      CHECK(read.cues[i].work_j == Approx(work / fingers).epsilon(1e-15));
      CHECK(read.cues[i].peak_force_n == peak);
    }
  }
}

TEST_CASE("what was not measured is not a number, and what is needed is asked for by name", "[data]") {
  TrialBodyReader reader(Unit::n_per_m);
  const std::string bare =
      R"({"series_place":1,"condition_place":2,"target":1,"said":1,"answer":"different","stimulus_1_n_per_m":900,"stimulus_2_n_per_m":400})";
  const CountedTrial trial = reader.read(bare);
  CHECK(trial.series == 1);
  CHECK(trial.condition == 2);
  CHECK(trial.said_different());
  CHECK_FALSE(trial.delivered(0).has_value());
  CHECK(std::isnan(trial.cues[1].work_j));

  const CountedTrial unfitted = reader.read(
      R"({"series_place":0,"condition_place":0,"target":0,"said":0,"answer":"same","presentations":[{"fingers":[)"
      R"({"stiffness_n_per_m":null,"work_j":0.5,"peak_force_n":2},{"stiffness_n_per_m":600,"work_j":1.5}]},{"fingers":[]}]})");
  CHECK(*unfitted.delivered(0) == 600);
  CHECK(unfitted.cues[0].work_j == 1);
  CHECK(unfitted.cues[0].peak_force_n == 2);
  CHECK_FALSE(unfitted.delivered(1).has_value());

  CHECK_THROWS_WITH(reader.read(R"({"series_place":1,"condition_place":2,"target":1,"said":1})"),
                    Catch::Contains("has no answer"));
  CHECK_THROWS_AS(reader.read(R"({"series_place":"one"})"), StorageError);
  CHECK_THROWS_AS(reader.read(R"({"series_place":1)"), StorageError);
  CHECK_THROWS_AS(reader.read("[]"), StorageError);
  CHECK_THROWS_AS(reader.read(""), StorageError);
}

}  // namespace
}  // namespace jnd
