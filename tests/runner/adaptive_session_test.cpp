// Whole sessions whose answers set the levels: stopping, catch trials, interruption anywhere, verification, thresholds.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>

#include <SQLiteCpp/SQLiteCpp.h>

#include "analysis/normal.h"
#include "data/adaptive_results.h"
#include "data/export.h"
#include "data/storage_error.h"
#include "data/study_analysis.h"
#include "data/study_results.h"
#include "protocols/adaptive_run.h"
#include "protocols/random_stream.h"
#include "runner/adaptive_text.h"
#include "runner/session_engine.h"
#include "runner/simulate.h"
#include "tests/catch.h"
#include "tests/runner/engine_fixture.h"

namespace jnd {
namespace {

using nlohmann::json;
using test::Bench;
using test::small_protocol;

const std::string kSource = JND_SOURCE_DIR;

json staircase_changes() {
  return json::parse(R"({
    "series": null,
    "design": {"trials_per_cell": null, "sampling": null,
      "procedure": {"kind": "staircase", "starts": [500, 100], "clamp": [20, 800], "up": 1, "down": 2, "step_up": 80, "step_down": 80,
                    "halve_after": [1, 2], "averaged_reversals": 4, "stop": {"reversals": 6, "at_most": 24}, "catch_share": 0.5}}
  })");
}
Protocol staircase(const json& more = {}) {
  json changes = staircase_changes();
  if (!more.is_null()) changes.merge_patch(more);
  return small_protocol(changes);
}
// Few enough trials to try every place.
Protocol short_staircase(const json& more = {}) {
  json changes = {
      {"design", {{"procedure", {{"averaged_reversals", 2}, {"stop", {{"reversals", 3}, {"at_most", 8}}}}}}}};
  if (!more.is_null()) changes.merge_patch(more);
  return staircase(changes);
}
Protocol quest(int trials) {
  json changes = staircase_changes();
  changes["design"]["procedure"] = {
      {"kind", "quest"},     {"starts", {300}}, {"clamp", {20, 800}}, {"guess_sd", 0.3}, {"gamma", 0.1},
      {"p_threshold", 0.75}, {"range", 3},      {"delta", 0.01},      {"beta", 2},       {"stop", {{"trials", trials}}},
      {"catch_share", 0.25}};
  return small_protocol(changes);
}

// Says "different" from this difference on.
std::function<std::optional<Judgement>(const TrialQuestion&)> sharp(double threshold) {
  return [threshold](const TrialQuestion& question) {
    const auto& [one, two] = question.trial.stimuli;
    return std::optional(std::abs(one - two) >= threshold ? Judgement::different : Judgement::same);
  };
}

// Ends the session before the k-th trial.
class EndBefore final : public SessionView {
 public:
  explicit EndBefore(int trials) : left_(trials) {}
  bool ready(const TrialOutline&) override { return left_-- > 0; }

 private:
  int left_;
};

struct Presented {
  int index, attempt;
  std::array<double, 2> stimuli;
  Judgement judgement;
  bool operator==(const Presented&) const = default;
};
std::vector<Presented> presented(const Bench& bench) {
  std::vector<Presented> all;
  for (const TrialRecord& record : bench.completed())
    all.push_back({record.trial.index, record.attempt, record.trial.stimuli, record.answer.judgement});
  return all;
}

std::vector<AdaptiveRow> rows_of(const Bench& bench) {
  return adaptive_rows(bench.log.events(), bench.protocol, "P01", SessionKind::simulated);
}

TEST_CASE("A staircase session ends with its reversals, at the threshold of a sharp observer") {
  Bench bench(staircase());
  bench.responder.rule = sharp(170);
  REQUIRE(bench.run() == SessionEnd::completed);
  const std::vector<TrialRecord> records = bench.completed();
  CHECK(records.size() < bench.plan.trials.size());
  for (const TrialRecord& record : records) {
    const Trial& planned = bench.plan.trials[static_cast<std::size_t>(record.trial.index) - 1];
    CHECK(record.trial.same == planned.same);
    CHECK(record.trial.track == planned.track);
    for (std::size_t i = 0; i < 2; ++i) {
      const double stimulus = record.trial.stimuli[i];
      if (planned.stimuli[i] != kSetByAnswers)
        CHECK(stimulus == 900);
      else
        CHECK((stimulus >= 100 && stimulus <= 880));
    }
  }
  const std::vector<AdaptiveRow> rows = rows_of(bench);
  REQUIRE(rows.size() == 2 * 3);  // conditions; two tracks and both
  for (const AdaptiveRow& row : rows) {
    CHECK(row.finished);
    CHECK(row.threshold.status == AdaptiveStatus::ok);
    CHECK(row.threshold.threshold == Approx(170).margin(20));  // the last steps are 20
    CHECK(row.false_alarms == 0);
    CHECK(row.catch_trials > 0);
    CHECK(row.weber == Approx(row.threshold.threshold / 900));
    if (row.track != 0) CHECK(row.reversals.size() == 6);
  }
}

TEST_CASE("Who feels nothing stays at the clamp, until the bound; who always says different has false alarms") {
  Bench never(staircase());
  never.responder.rule = [](const TrialQuestion&) { return std::optional(Judgement::same); };
  REQUIRE(never.run() == SessionEnd::completed);
  CHECK(never.completed().size() == never.plan.trials.size());
  for (const AdaptiveRow& row : rows_of(never)) {
    CHECK(row.finished);
    CHECK(row.threshold.status == AdaptiveStatus::pinned_at_clamp);
    CHECK(std::isnan(row.threshold.threshold));
    CHECK(row.trials == (row.track == 0 ? 48 : 24));
    CHECK(row.false_alarm_rate == 0);
  }
  Bench always(staircase());
  always.responder.rule = [](const TrialQuestion&) { return std::optional(Judgement::different); };
  REQUIRE(always.run() == SessionEnd::completed);
  for (const AdaptiveRow& row : rows_of(always)) {
    CHECK(row.false_alarm_rate == 1);
    CHECK(row.threshold.status == AdaptiveStatus::pinned_at_clamp);
  }
}

TEST_CASE("A session interrupted before any trial, or after any event, ends like an undisturbed one") {
  for (const Protocol& protocol :
       {short_staircase(), quest(10), short_staircase({{"design", {{"conditions", "mixed"}}}})}) {
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
    SessionEngine engine(bench.protocol, bench.plan, bench.rig, bench.responder, log, bench.clock, quiet, bench.stop);
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
    run.answered(planned, record.answer.judgement);
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
    if (record.trial.same) {
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
    bool ready(const TrialOutline& outline) override {
      CHECK(outline.at_most);
      CHECK(outline.number == ++trials);
      CHECK(outline.total <= last_total);
      CHECK(outline.number <= outline.total);
      last_total = outline.total;
      return true;
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

// Observers with P("different") = Phi((difference - 200) / 100), catch trials included: the staircases' mean threshold
// is where the rule settles, that of QUEST is where its own psychometric function, fitted to nothing, agrees.
TEST_CASE("Thresholds of known observers are found within their error") {
  constexpr double kCriterion = 200, kSigma = 100;
  constexpr int kObservers = 40;
  const Protocol protocol = staircase(
      {{"design", {{"procedure", {{"averaged_reversals", 8}, {"stop", {{"reversals", 12}, {"at_most", 90}}}}}}}});
  std::vector<AdaptiveRow> rows;
  for (int observer = 1; observer <= kObservers; ++observer) {
    Bench bench(protocol, observer);
    bench.responder.rule = [&](const TrialQuestion& question) {
      RandomStream noise(3, static_cast<std::uint64_t>(observer), "noise",
                         static_cast<std::uint64_t>(question.trial.index));
      const auto& [one, two] = question.trial.stimuli;
      return std::optional(std::abs(one - two) + kSigma * noise.normal() > kCriterion ? Judgement::different
                                                                                      : Judgement::same);
    };
    REQUIRE(bench.run() == SessionEnd::completed);
    const std::vector<AdaptiveRow> mine = rows_of(bench);
    rows.insert(rows.end(), mine.begin(), mine.end());
  }
  const double truth = kCriterion + kSigma * normal_quantile(std::sqrt(0.5));
  for (const AdaptiveGroup& group : adaptive_group(rows, protocol)) {
    CAPTURE(group.mean, group.sd);
    CHECK(group.n > 0.9 * kObservers);
    CHECK(group.of == kObservers);
    CHECK(group.mean == Approx(truth).margin(5 * group.sd / std::sqrt(group.n) + 5));
    CHECK(group.sd < 60);
    CHECK(group.false_alarms == Approx(normal_cdf(-2)).margin(0.01));
  }
}

TEST_CASE("QUEST finds the threshold of an observer with its psychometric function") {
  const Protocol protocol = quest(60);
  const QuestParameters parameters = quest_of_track(*protocol.design.procedure, 1);
  const double shift = quest_threshold_shift(parameters), truth = 220;
  std::vector<AdaptiveRow> rows;
  for (int observer = 1; observer <= 40; ++observer) {
    Bench bench(protocol, observer);
    bench.responder.rule = [&](const TrialQuestion& question) {
      RandomStream noise(4, static_cast<std::uint64_t>(observer), "noise",
                         static_cast<std::uint64_t>(question.trial.index));
      const double difference = std::abs(question.trial.stimuli[0] - question.trial.stimuli[1]);
      const double p = difference > 0 ? quest_probability(parameters, shift, std::log10(difference), std::log10(truth))
                                      : parameters.gamma;
      return std::optional(noise.uniform() < p ? Judgement::different : Judgement::same);
    };
    REQUIRE(bench.run() == SessionEnd::completed);
    const std::vector<AdaptiveRow> mine = rows_of(bench);
    rows.insert(rows.end(), mine.begin(), mine.end());
  }
  for (const AdaptiveGroup& group : adaptive_group(rows, protocol)) {
    CAPTURE(group.mean, group.sd);
    CHECK(group.n >= 38);
    CHECK(group.mean == Approx(truth).margin(4 * group.sd / std::sqrt(group.n) + 10));
    CHECK(group.false_alarms == Approx(0.1).margin(0.03));
  }
}

struct TemporaryFolder {
  TemporaryFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "jnd-test-XXXXXX").string();
    path = mkdtemp(pattern.data());
  }
  ~TemporaryFolder() { std::filesystem::remove_all(path); }
  std::filesystem::path path;
};

std::string problems_of(const std::filesystem::path& path) {
  std::string all;
  for (const std::string& problem : verify(*Study::open(path, Study::Access::read_only)).problems)
    all += problem + "\n";
  return all;
}

TEST_CASE("A simulated adaptive study: verified, read, exported; a changed answer shows in the levels after it") {
  const Protocol protocol = staircase(
      {{"trial", {{"explore_s", 0.5}}}, {"design", {{"procedure", {{"stop", {{"reversals", 4}, {"at_most", 12}}}}}}}});
  const RigDescription rig{.spec = load_rig_spec(kSource + "/devices/specs/rrs3.json")};
  const ParticipantProfile profile = load_profile(kSource + "/devices/profiles/chinello2017.json");
  Simulation simulation{protocol, rig, profile};
  simulation.participants = 2;
  simulation.threads = 2;
  simulation.seed = 11;
  simulation.record = RecordPolicy::off;
  const TemporaryFolder folder;
  const auto path = folder.path / "s.jnd";
  {
    const auto study = Study::create(path, protocol.name, protocol.bytes, 11, {simulated_epoch_ns(1), 0});
    REQUIRE(simulate_study(simulation, *study).completed == 2);
    CHECK(verify(*study).problems == std::vector<std::string>{});
    const AdaptiveResults results = adaptive_results(*study, protocol, SessionKind::simulated);
    REQUIRE(results.rows.size() == 2 * 2 * 3);
    CHECK(results.group.size() == 2);
    for (const AdaptiveRow& row : results.rows) CHECK(row.finished);
    // The same without a study, on one thread.
    simulation.threads = 1;
    const AdaptiveResults again = simulate_thresholds(simulation);
    CHECK(to_json(again, protocol) == to_json(results, protocol));
    // The pipeline of counts does not fail on it.
    const StudyAnalysis counts = analyze(*study, protocol, SessionKind::simulated);
    export_csv(*study, protocol, results_of(counts, protocol), folder.path / "csv", false);
    study->close();
  }
  const auto tampered = [&](const std::string& sql) {
    const auto copy = folder.path / "copy.jnd";
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
      tampered("UPDATE event SET body = replace(body, '\"answer\":\"same\"', '\"answer\":\"different\"') WHERE kind "
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

TEST_CASE("Thresholds as text and JSON name the condition, the status and what they rest on") {
  Bench bench(staircase());
  bench.responder.rule = sharp(170);
  bench.run();
  AdaptiveResults results;
  results.rows = rows_of(bench);
  results.group = adaptive_group(results.rows, bench.protocol);
  const std::string text = to_text(results, bench.protocol);
  CHECK_THAT(text, Catch::Contains("threshold N/m") && Catch::Contains("70.7 %") && Catch::Contains("1 of 1"));
  CHECK_THAT(text, !Catch::Contains("nan"));
  const auto count = [](const std::string& all, const std::string& part) {
    int n = 0;
    for (std::size_t at = all.find(part); at != std::string::npos; at = all.find(part, at + 1)) ++n;
    return n;
  };
  CHECK(count(to_text(results, bench.protocol, true), "P01") == 6);
  CHECK(count(text, "P01") == 2);
  const nlohmann::ordered_json json = to_json(results, bench.protocol);
  CHECK(json["rows"].size() == 6);
  CHECK(json["rows"][0]["track"] == 1);
  CHECK(json["rows"][2]["track"].is_null());
  CHECK(json["rows"][0]["reversals"].size() == 6);
  CHECK(json["procedure"]["target"].get<double>() == Approx(std::sqrt(0.5)));
}

}  // namespace
}  // namespace jnd
