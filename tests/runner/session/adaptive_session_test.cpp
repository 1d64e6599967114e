// Sessions whose answers set the levels, and the thresholds that they end with.
#include <cmath>
#include <filesystem>
#include <map>

#include <SQLiteCpp/SQLiteCpp.h>

#include "analysis/numerics/normal.h"
#include "data/blocks/result_blocks.h"
#include "data/export/export.h"
#include "data/log/storage_error.h"
#include "data/results/study_results.h"
#include "data/verify/verify.h"
#include "protocols/planning/adaptive_run.h"
#include "protocols/random_stream.h"
#include "protocols/tasks/task.h"
#include "runner/results/analysis_text.h"
#include "runner/session/session_engine.h"
#include "runner/session/simulate.h"
#include "tests/catch.h"
#include "tests/runner/session/adaptive_fixture.h"
#include "tests/temporary_folder.h"

namespace jnd {
namespace {

// Whole sessions whose answers set the levels: stopping, catch trials, interruption anywhere, verification, thresholds.

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

// What adaptive sessions end with: thresholds of known observers, and a study of them verified, read and exported.

using test::add_observer;
using test::joint_staircase;

// The group's threshold in each condition.
std::vector<TaskGroupRow> group_of(TaskResults results, const Protocol& protocol) {
  results.outcomes = measured_outcomes(protocol);
  add_group(results, protocol);
  std::erase_if(results.group, [](const TaskGroupRow& row) { return row.outcome != 0; });
  return results.group;
}

// Observers with P("different") = Phi((difference - 200) / 100), catch trials included: the staircases' mean threshold
// is where the rule settles, that of QUEST is where its own psychometric function, fitted to nothing, agrees.
TEST_CASE("Thresholds of known observers are found within their error", "[long]") {
  constexpr double kCriterion = 200, kSigma = 100;
  constexpr int kObservers = 40;
  const Protocol protocol = staircase(
      {{"design", {{"procedure", {{"averaged_reversals", 8}, {"stop", {{"reversals", 12}, {"at_most", 90}}}}}}}});
  TaskResults results;
  for (int observer = 1; observer <= kObservers; ++observer) {
    Bench bench(protocol, observer);
    bench.responder.rule = [&](const TrialQuestion& question) {
      RandomStream noise(3, static_cast<std::uint64_t>(observer), "noise",
                         static_cast<std::uint64_t>(question.trial.index));
      const double one = question.trial.stimuli[0], two = question.trial.stimuli[1];
      return std::optional(std::abs(one - two) + kSigma * noise.normal() > kCriterion ? kClassDifferent : kClassSame);
    };
    REQUIRE(bench.run() == SessionEnd::completed);
    add_observer(results, bench);
  }
  const double truth = kCriterion + kSigma * normal_quantile(std::sqrt(0.5));
  for (const TaskGroupRow& group : group_of(results, protocol)) {
    CAPTURE(group.mean.mean, group.mean.sd);
    CHECK(group.mean.n > 0.9 * kObservers);
    CHECK(group.participants == kObservers);
    CHECK(group.mean.mean == Approx(truth).margin(5 * group.mean.sd / std::sqrt(group.mean.n) + 5));
    CHECK(group.mean.sd < 60);
    CHECK(group.false_alarm_rate == Approx(normal_cdf(-2)).margin(0.01));
  }
}

TEST_CASE("QUEST finds the threshold of an observer with its psychometric function") {
  const Protocol protocol = quest(60);
  const QuestParameters parameters = quest_of_track(*protocol.design.procedure, 1);
  const double shift = quest_threshold_shift(parameters), truth = 220;
  TaskResults results;
  for (int observer = 1; observer <= 40; ++observer) {
    Bench bench(protocol, observer);
    bench.responder.rule = [&](const TrialQuestion& question) {
      RandomStream noise(4, static_cast<std::uint64_t>(observer), "noise",
                         static_cast<std::uint64_t>(question.trial.index));
      const double difference = std::abs(question.trial.stimuli[0] - question.trial.stimuli[1]);
      const double p = difference > 0 ? quest_probability(parameters, shift, std::log10(difference), std::log10(truth))
                                      : parameters.gamma;
      return std::optional(noise.uniform() < p ? kClassDifferent : kClassSame);
    };
    REQUIRE(bench.run() == SessionEnd::completed);
    add_observer(results, bench);
  }
  for (const TaskGroupRow& group : group_of(results, protocol)) {
    CAPTURE(group.mean.mean, group.mean.sd);
    CHECK(group.mean.n >= 38);
    CHECK(group.mean.mean == Approx(truth).margin(4 * group.mean.sd / std::sqrt(group.mean.n) + 10));
    CHECK(group.false_alarm_rate == Approx(0.1).margin(0.03));
  }
}

// Observers with P("different") = Phi(difference / 220 - 0.75): the JND is found whatever the criterion, by the Bayesian
// procedure and by a staircase whose answers are taken together.
TEST_CASE("The posterior of all answers finds the JND of known observers", "[long]") {
  constexpr double kJnd = 220, kCriterion = 0.75;
  constexpr int kObservers = 30;
  for (const Protocol& protocol : {posterior({{"trials", 48}}), joint_staircase(48)}) {
    TaskResults results;
    int covered = 0, all = 0;
    for (int observer = 1; observer <= kObservers; ++observer) {
      Bench bench(protocol, observer);
      bench.responder.rule = [&](const TrialQuestion& question) {
        RandomStream noise(5, static_cast<std::uint64_t>(observer), "noise",
                           static_cast<std::uint64_t>(question.trial.index));
        const double difference = std::abs(question.trial.stimuli[0] - question.trial.stimuli[1]);
        return std::optional(noise.uniform() < normal_cdf(difference / kJnd - kCriterion) ? kClassDifferent
                                                                                          : kClassSame);
      };
      REQUIRE(bench.run() == SessionEnd::completed);
      for (const AdaptiveTrack& track : tracks_of(bench)) {
        CHECK(track.finished);
        CHECK(track_threshold(track, protocol).n == static_cast<int>(track.levels.size()) + track.catch_trials);
      }
      add_observer(results, bench);
    }
    for (const TaskEstimateRow& row : results.estimates) {
      const TaskEstimate& jnd = row.estimates.values[0];
      if (!jnd.value) continue;
      ++all;
      covered += *jnd.low < kJnd && kJnd < *jnd.high ? 1 : 0;
    }
    CHECK(all > 0.95 * 2 * kObservers);
    CHECK(covered > 0.85 * all);
    for (const TaskGroupRow& group : group_of(results, protocol)) {
      CAPTURE(group.mean.mean, group.mean.sd);
      CHECK(group.mean.mean == Approx(kJnd).margin(4 * group.mean.sd / std::sqrt(group.mean.n) + 15));
      CHECK(group.mean.sd < 90);
      CHECK(group.false_alarm_rate == Approx(normal_cdf(-kCriterion)).margin(0.06));
    }
  }
}

std::string problems_of(const std::filesystem::path& path) {
  std::string all;
  for (const Problem& problem : verify(*Study::open(path, Study::Access::read_only)).problems)
    all += problem.text + "\n";
  return all;
}

// Thresholds name the condition, the status and what they rest on.
void check_output(const StudyResults& results, const Protocol& protocol) {
  const std::vector<Block> blocks = result_blocks(results, protocol);
  const Block* const tracks = block_named(blocks, "tracks");
  REQUIRE(tracks != nullptr);
  const std::string text = answer_text(results, blocks, protocol) + text_of(table_of(*tracks));
  CHECK_THAT(text, Catch::Contains("threshold N/m") && Catch::Contains("70.7 %") && Catch::Contains("2 of 2"));
  CHECK_THAT(text, !Catch::Contains("nan"));
  const nlohmann::ordered_json rows = to_json(results, blocks, protocol).at("tracks");
  REQUIRE(rows.size() == 2 * 2 * 3);
  CHECK(rows[0]["track"] == 1);
  CHECK(rows[2]["track"].is_null());
  const TrackRow& first = results.task.tracks.front();
  CHECK(rows[0]["reversals"] == first.reversals);
  CHECK(rows[0]["condition"] == "S");
  CHECK(rows[0]["status"] == to_string(first.threshold->status));
}

TEST_CASE("A simulated adaptive study: verified, read, exported; a changed answer shows in the levels after it") {
  const Protocol protocol = staircase(
      {{"trial", {{"explore_s", 0.5}}}, {"design", {{"procedure", {{"stop", {{"reversals", 4}, {"at_most", 12}}}}}}}});
  const RigDescription rig{.spec = load_rig_spec(JND_SOURCE_DIR "/devices/specs/rrs3.json")};
  const ParticipantProfile profile = load_profile(JND_SOURCE_DIR "/devices/profiles/chinello2017.json");
  Simulation simulation{protocol, rig, profile};
  simulation.participants = 2;
  simulation.threads = 2;
  simulation.seed = 11;
  simulation.record = RecordPolicy::off;
  const TemporaryFolder folder;
  const auto path = folder.path() / "s.jnd";
  {
    const auto study = Study::create(path, protocol.name, protocol.bytes, 11, {simulated_epoch_ns(1), 0});
    REQUIRE(simulate_study(simulation, *study).completed == 2);
    CHECK(verify(*study).problems == std::vector<Problem>{});
    const StudyResults results = results_of(*study, protocol, SessionKind::simulated);
    REQUIRE(results.task.tracks.size() == 2 * 2 * 3);
    for (const TrackRow& row : results.task.tracks) CHECK(row.finished);
    check_output(results, protocol);
    export_csv(*study, protocol, results, folder.path() / "csv", false);
    study->close();
  }
  const auto tampered = [&](const std::string& sql) {
    const auto copy = folder.path() / "copy.jnd";
    std::filesystem::copy_file(path, copy, std::filesystem::copy_options::overwrite_existing);
    {
      SQLite::Database database(copy.string(), SQLite::OPEN_READWRITE);
      database.exec("DROP TRIGGER event_no_update;" + sql);
    }
    return problems_of(copy);
  };
  CHECK(problems_of(path).empty());
  const std::string where =
      " WHERE kind = 'trial.completed' AND session IN (SELECT min(session) FROM event WHERE session "
      "<> 'study') AND seq = ";
  // All "same" turned into "different": the levels after it are not those that follow.
  CHECK_THAT(
      tampered(
          "UPDATE event SET body = replace(body, '\"answer\":\"same\",\"said\":0', '\"answer\":\"different\",\"said\":1') WHERE kind "
          "= 'trial.completed'"),
      Catch::Contains("after the answers before it"));
  // A stimulus in the third decimal.
  CHECK_THAT(tampered("UPDATE event SET body = json_set(body, '$.stimulus_1_n_per_m', "
                      "json_extract(body, '$.stimulus_1_n_per_m') + 0.001)" +
                      where + "5"),
             Catch::Contains("event 5: trial") && Catch::Contains("presented"));
  CHECK_THAT(tampered("UPDATE event SET body = json_set(body, '$.track', 2 - json_extract(body, '$.track') / 2)" +
                      where + "5") +
                 tampered("UPDATE event SET body = json_set(body, '$.track', 7)" + where + "5"),
             Catch::Contains("event 5: trial"));
}

}  // namespace
}  // namespace jnd
