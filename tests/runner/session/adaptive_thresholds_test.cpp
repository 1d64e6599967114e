// What adaptive sessions end with: thresholds of known observers, and a study of them verified, read and exported.
#include <cmath>
#include <filesystem>

#include <SQLiteCpp/SQLiteCpp.h>

#include "analysis/numerics/normal.h"
#include "data/export/export.h"
#include "data/results/adaptive_results.h"
#include "data/results/study_results.h"
#include "data/verify/verify.h"
#include "protocols/random_stream.h"
#include "protocols/tasks/same_different_task.h"
#include "runner/results/adaptive_text.h"
#include "runner/session/session_engine.h"
#include "runner/session/simulate.h"
#include "tests/catch.h"
#include "tests/runner/session/adaptive_fixture.h"
#include "tests/temporary_folder.h"

namespace jnd {
namespace {

using nlohmann::json;
using test::Bench;
using test::joint_staircase;
using test::posterior;
using test::quest;
using test::rows_of;
using test::sharp;
using test::staircase;

// Observers with P("different") = Phi((difference - 200) / 100), catch trials included: the staircases' mean threshold
// is where the rule settles, that of QUEST is where its own psychometric function, fitted to nothing, agrees.
TEST_CASE("Thresholds of known observers are found within their error", "[long]") {
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
      const double one = question.trial.stimuli[0], two = question.trial.stimuli[1];
      return std::optional(std::abs(one - two) + kSigma * noise.normal() > kCriterion ? kClassDifferent : kClassSame);
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
      return std::optional(noise.uniform() < p ? kClassDifferent : kClassSame);
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

// Observers with P("different") = Phi(difference / 220 - 0.75): the JND is found whatever the criterion, by the Bayesian
// procedure and by a staircase whose answers are taken together.
TEST_CASE("The posterior of all answers finds the JND of known observers", "[long]") {
  constexpr double kJnd = 220, kCriterion = 0.75;
  constexpr int kObservers = 30;
  for (const Protocol& protocol : {posterior({{"trials", 48}}), joint_staircase(48)}) {
    std::vector<AdaptiveRow> rows;
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
      for (const AdaptiveRow& row : rows_of(bench)) {
        CHECK(row.finished);
        CHECK(row.threshold.n == row.trials + row.catch_trials);
        rows.push_back(row);
        if (row.track != 0 || row.threshold.status != AdaptiveStatus::ok) continue;
        ++all;
        covered += row.threshold.low < kJnd && kJnd < row.threshold.high ? 1 : 0;
      }
    }
    CHECK(all > 0.95 * 2 * kObservers);
    CHECK(covered > 0.85 * all);
    for (const AdaptiveGroup& group : adaptive_group(rows, protocol)) {
      CAPTURE(group.mean, group.sd);
      CHECK(group.mean == Approx(kJnd).margin(4 * group.sd / std::sqrt(group.n) + 15));
      CHECK(group.sd < 90);
      CHECK(group.false_alarms == Approx(normal_cdf(-kCriterion)).margin(0.06));
    }
  }
}

std::string problems_of(const std::filesystem::path& path) {
  std::string all;
  for (const Problem& problem : verify(*Study::open(path, Study::Access::read_only)).problems)
    all += problem.text + "\n";
  return all;
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
    export_csv(*study, protocol, results_of(counts, protocol), folder.path() / "csv", false);
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
