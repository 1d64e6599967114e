// Whole sessions whose answers set the levels: stopping, catch trials, interruption anywhere, verification, thresholds.
#include <map>

#include "data/log/storage_error.h"
#include "protocols/planning/adaptive_run.h"
#include "protocols/tasks/task.h"
#include "runner/session/session_engine.h"
#include "tests/catch.h"
#include "tests/runner/session/adaptive_fixture.h"

namespace jnd {
namespace {

using nlohmann::json;
using test::Bench;
using test::posterior;
using test::quest;
using test::sharp;
using test::short_staircase;
using test::staircase;
using test::tracks_of;

// Ends the session before the k-th trial.
class EndBefore final : public SessionView {
 public:
  explicit EndBefore(int trials) : left_(trials) {}
  OperatorRequest ready(const TrialOutline&) override {
    return {left_-- > 0 ? Request::go_on : Request::end_for_now, {}};
  }

 private:
  int left_;
};

struct Presented {
  int index, attempt;
  Intervals stimuli;
  int said;
  bool operator==(const Presented&) const = default;
};
std::vector<Presented> presented(const Bench& bench) {
  std::vector<Presented> all;
  for (const TrialRecord& record : bench.completed())
    all.push_back({record.trial.index, record.attempt, record.trial.stimuli, record.answer.said});
  return all;
}

TEST_CASE("A staircase session ends with its reversals, at the threshold of a sharp observer") {
  Bench bench(staircase());
  bench.responder.rule = sharp(170);
  REQUIRE(bench.run() == SessionEnd::completed);
  const std::vector<TrialRecord> records = bench.completed();
  CHECK(records.size() < bench.plan.trials.size());
  for (const TrialRecord& record : records) {
    const Trial& planned = bench.plan.trials[static_cast<std::size_t>(record.trial.index) - 1];
    CHECK((record.trial.target == kClassSame) == (planned.target == kClassSame));
    CHECK(record.trial.track == planned.track);
    for (std::size_t i = 0; i < 2; ++i) {
      const double stimulus = record.trial.stimuli[i];
      if (planned.stimuli[i] != set_by_answers(900))
        CHECK(stimulus == 900);
      else
        CHECK((stimulus >= 100 && stimulus <= 880));
    }
  }
  const std::vector<AdaptiveTrack> tracks = tracks_of(bench);
  REQUIRE(tracks.size() == 2 * 2);  // conditions x starts
  for (const AdaptiveTrack& track : tracks) {
    CHECK(track.finished);
    CHECK(track_threshold(track, bench.protocol).status == AdaptiveStatus::ok);
    CHECK(track_threshold(track, bench.protocol).threshold == Approx(170).margin(20));  // the last steps are 20
    CHECK(track.false_alarms == 0);
    CHECK(track.catch_trials > 0);
    CHECK(track.reversals.size() == 6);
  }
  TaskResults results;
  test::add_observer(results, bench);
  REQUIRE(results.estimates.size() == 2);
  for (const TaskEstimateRow& row : results.estimates) {
    CHECK(row.estimates.status == "ok");
    CHECK(row.estimates.values[0].value.value() == Approx(170).margin(20));
    CHECK(row.estimates.values[1].value.value() == Approx(*row.estimates.values[0].value / 900));  // Weber fraction
    CHECK(row.estimates.tracks.used == 2);
  }
}

TEST_CASE("Who feels nothing stays at the clamp, until the bound; who always says different has false alarms") {
  for (const int said : {kClassSame, kClassDifferent}) {
    Bench bench(staircase());
    bench.responder.rule = [said](const TrialQuestion&) { return std::optional(said); };
    REQUIRE(bench.run() == SessionEnd::completed);
    if (said == kClassSame) CHECK(bench.completed().size() == bench.plan.trials.size());
    TaskResults results;
    test::add_observer(results, bench);
    for (const TaskEstimateRow& row : results.estimates) {
      CHECK(row.estimates.status == "pinned_at_clamp");
      CHECK_FALSE(row.estimates.values[0].value);
      CHECK(row.catch_trials > 0);
      CHECK(row.false_alarms == (said == kClassSame ? 0 : row.catch_trials));
      if (said == kClassSame) CHECK(row.trials == 2 * 24);
    }
    for (const AdaptiveTrack& track : tracks_of(bench)) {
      CHECK(track.finished);
      CHECK(track_threshold(track, bench.protocol).status == AdaptiveStatus::pinned_at_clamp);
    }
  }
}

TEST_CASE("A session interrupted before any trial, or after any event, ends like an undisturbed one") {
  for (const Protocol& protocol :
       {short_staircase(), quest(10), posterior({{"trials", 9}}), posterior({{"precision", 0.5}, {"at_most", 20}}),
        short_staircase({{"design", {{"conditions", "mixed"}}}})}) {
    Bench undisturbed(protocol);
    undisturbed.responder.rule = sharp(170);
    REQUIRE(undisturbed.run() == SessionEnd::completed);
    const std::vector<Presented> expected = presented(undisturbed);
    for (int k = 0; k <= static_cast<int>(expected.size()); ++k) {
      Bench bench(protocol);
      bench.responder.rule = sharp(170);
      EndBefore view(k);
      REQUIRE(bench.run(view) ==
              (k < static_cast<int>(expected.size()) ? SessionEnd::interrupted : SessionEnd::completed));
      REQUIRE(bench.run() == SessionEnd::completed);
      REQUIRE(presented(bench) == expected);
    }
  }
}

TEST_CASE("Killed after every single event, a session with faults still ends alike") {
  const auto fault = [](const PresentRequest& request) {
    return request.id.trial % 7 == 3 && request.id.attempt == 1 && request.id.interval == 1 ? Fault::stale_pose
                                                                                            : Fault::none;
  };
  const Protocol protocol = short_staircase();
  Bench undisturbed(protocol);
  undisturbed.responder.rule = sharp(170);
  undisturbed.rig.fault = fault;
  REQUIRE(undisturbed.run() == SessionEnd::completed);
  REQUIRE_FALSE(replay(undisturbed.log.events()).voided.empty());

  // One event a start, but that a device.fault comes with the void that it causes.
  class OneEvent final : public SessionLog {
   public:
    explicit OneEvent(MemoryLog& kept) : kept_(kept) {}
    void append(std::string_view kind, const nlohmann::ordered_json& body, Stamp stamp) override {
      if (spent_) throw StorageError("killed");
      spent_ = kind != event_kind::kDeviceFault;
      kept_.append(kind, body, stamp);
    }
    std::vector<Event> events() const override { return kept_.events(); }

   private:
    MemoryLog& kept_;
    bool spent_ = false;
  };
  Bench bench(protocol);
  bench.responder.rule = sharp(170);
  bench.rig.fault = fault;
  SessionEnd end = SessionEnd::interrupted;
  for (int starts = 0; end != SessionEnd::completed; ++starts) {
    REQUIRE(starts < 2000);
    OneEvent log(bench.log);
    SessionView quiet;
    const SessionParts parts = bench.parts_for(quiet, log);
    SessionEngine engine(parts);
    try {
      end = engine.run(replay(log.events()));
    } catch (const StorageError&) {
    }
  }
  CHECK(presented(bench) == presented(undisturbed));
}

TEST_CASE("A voided trial comes back at the level that its track has by then") {
  Bench bench(staircase());
  bench.responder.rule = sharp(170);
  bench.rig.fault = [&](const PresentRequest& request) {
    return request.id.trial == 1 && request.id.attempt == 1 ? Fault::non_finite : Fault::none;
  };
  REQUIRE(bench.run() == SessionEnd::completed);
  AdaptiveRun run(bench.protocol);
  for (const TrialRecord& record : bench.completed()) {
    const Trial& planned = bench.plan.trials[static_cast<std::size_t>(record.trial.index) - 1];
    CHECK(record.trial == run.resolved(planned));
    CHECK_FALSE(run.over(planned));
    run.answered(planned, record.answer);
  }
}

TEST_CASE("The share of catch trials is kept all along, and both stiffnesses are among them") {
  Bench bench(staircase(
      {{"design", {{"procedure", {{"stop", {{"reversals", nullptr}, {"at_most", nullptr}, {"trials", 24}}}}}}}}));
  bench.responder.rule = sharp(170);
  REQUIRE(bench.run() == SessionEnd::completed);
  std::map<std::pair<int, int>, std::pair<int, int>> seen;  // condition and track: trials, catch trials
  int references = 0, comparisons = 0;
  for (const TrialRecord& record : bench.completed()) {
    auto& [trials, catches] = seen[{record.trial.condition, record.trial.track}];
    ++trials;
    if ((record.trial.target == kClassSame)) {
      ++catches;
      ++(record.trial.stimuli[0] == 900 ? references : comparisons);
    }
    if (trials % 8 == 0) CHECK(catches * 2 == trials);
  }
  CHECK(seen.size() == 4);
  for (const auto& [track, counts] : seen) CHECK(counts == std::pair(48, 24));
  CHECK(references == 48);
  CHECK(comparisons == 48);
}

TEST_CASE("The outline counts down what may still come") {
  class Watcher final : public SessionView {
   public:
    OperatorRequest ready(const TrialOutline& outline) override {
      CHECK(outline.at_most);
      CHECK(outline.number == ++trials);
      CHECK(outline.total <= last_total);
      CHECK(outline.number <= outline.total);
      last_total = outline.total;
      return {};
    }
    int trials = 0, last_total = 1 << 20;
  };
  Bench bench(staircase());
  bench.responder.rule = sharp(170);
  Watcher watcher;
  REQUIRE(bench.run(watcher) == SessionEnd::completed);
  // The last trial's total counts what its own answer may make superfluous.
  CHECK(watcher.last_total >= watcher.trials);
  CHECK(watcher.last_total < main_trial_count(bench.plan));
}

}  // namespace
}  // namespace jnd
