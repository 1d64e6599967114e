// Questionnaires of free interaction: tests against numbers computed by hand, choices and times out of a log.
#include "data/results/questionnaire_results.h"

#include <algorithm>
#include <cmath>

#include "analysis/numerics/special_values.h"
#include "data/blocks/result_blocks.h"
#include "data/log/exploration_body.h"
#include "data/log/replay.h"
#include "data/methods/methods_text.h"
#include "tests/catch.h"
#include "tests/data/exploration_fixture.h"

namespace jnd {
namespace {

int place_of(const std::string& id) {
  const auto& questions = experiment2().questions;
  for (std::size_t i = 0; i < questions.size(); ++i)
    if (questions[i].id == id) return static_cast<int>(i);
  return -1;
}

// Participants x (C, N).
RatedQuestion paired(const std::string& id, const std::vector<double>& ratings) {
  return {.question = place_of(id), .paired = true, .ratings = ratings};
}

const RatedQuestion kUntied = paired("QB1", {2, 1, 4, 2, 6, 3, 8, 4, 8, 3, 9, 3});  // C - N: 1, 2, 3, 4, 5, 6
const RatedQuestion kTied = paired("QB2", {2, 1, 3, 2, 4, 3, 5, 4, 6, 5, 6, 7});    // 1, 1, 1, 1, 1, -1
const RatedQuestion kEqual = paired("QB3", {5, 5, 4, 4, 3, 3, 2, 2, 1, 1, 9, 9});   // no difference
const RatedQuestion kMissing = paired("QB4", {5, 4, kNaN, 4, 3, 2, 2, kNaN, 1, 2, 9, 8});

TEST_CASE("the tests of the items are Wilcoxon's, by hand", "[data]") {
  const QuestionnaireResults results = questionnaire_of({kUntied, kTied}, 6, experiment2());
  REQUIRE(results.tests.items.size() == 2);
  const ItemPair& untied = results.tests.items[0].pairs.front();
  CHECK(untied.test.v == 21);
  CHECK(untied.test.p == Approx(2.0 / 64));  // only one of the 64 sign patterns is as extreme, on either side
  CHECK(untied.p == Approx(2.0 / 64));
  CHECK(untied.test.rank_biserial == 1);
  const ItemPair& tied = results.tests.items[1].pairs.front();
  CHECK(tied.test.v == 17.5);          // midranks of 3.5
  CHECK(tied.p == Approx(14.0 / 64));  // none or one, five or six of one sign
  CHECK(tied.test.rank_biserial == Approx((17.5 - 3.5) / 21));
  // The normal p with the corrections for continuity and ties: V - 10.5 = 7, variance 22.75 - (216 - 6) / 48.
  const double z = (7 - 0.5) / std::sqrt(22.75 - 210.0 / 48);
  CHECK(tied.test.p == Approx(std::erfc(z / std::sqrt(2.0))).epsilon(1e-12));
  CHECK(results.tests.family == 2);
  CHECK(untied.p_holm == Approx(4.0 / 64));
  CHECK(tied.p_holm == Approx(14.0 / 64));
  CHECK(untied.p_bh == Approx(4.0 / 64));
  CHECK(results.below_alpha.exact == 1);
  CHECK(results.below_alpha.as_r == 1);
  CHECK(results.below_alpha.holm == 0);
}

TEST_CASE("an item without any difference is no test, and the family does not count it", "[data]") {
  const QuestionnaireResults results = questionnaire_of({kUntied, kEqual}, 6, experiment2());
  CHECK(results.tests.family == 1);
  CHECK(std::isnan(results.tests.items[1].pairs.front().p));
  CHECK(results.tests.items[0].pairs.front().p_holm == Approx(2.0 / 64));
}

TEST_CASE("scores are over those who answered, pairs over those who answered both", "[data]") {
  const QuestionnaireResults results = questionnaire_of({kMissing}, 6, experiment2());
  const QuestionnaireItem& item = results.items.front();
  CHECK(item.scores[0].mean.n == 5);
  CHECK(item.scores[0].mean.mean == Approx(4));
  CHECK(item.scores[1].mean.n == 5);
  CHECK(results.tests.items.front().pairs.front().test.n == 4);
  REQUIRE(item.scores[0].sides);
  CHECK(item.scores[0].sides->below == 3);
  CHECK(item.scores[0].sides->at == 1);
  CHECK(item.scores[0].sides->above == 1);
}

TEST_CASE("an item rated once has scores and no test", "[data]") {
  const QuestionnaireResults results =
      questionnaire_of({{.question = place_of("QA1"), .ratings = {8, 9, 7, kNaN, 9, 8}}}, 6, experiment2());
  CHECK(results.tests.items.empty());
  REQUIRE(results.items.size() == 1);
  CHECK(results.items.front().scores.front().condition == -1);
  CHECK(results.items.front().scores.front().mean.mean == Approx(8.2));
  CHECK(results.items.front().scores.front().median.median == 8);
}

TEST_CASE("a study of free interaction is read out of its log", "[data]") {
  const TemporaryFolder folder;
  const auto study = new_study(folder / "e2.sqlite", experiment2());
  run_exploration(*study, 1, 8, 3, "wearing the devices");
  run_exploration(*study, 2, 7, 4, "wearing the devices");
  run_exploration(*study, 3, 6, 5, "bare hands", 60);
  const StudyResults results = results_of(*study, experiment2(), SessionKind::simulated);
  const QuestionnaireResults& all = results.questionnaire;
  CHECK(all.participants == 3);
  CHECK(all.items.size() == 22);
  CHECK(all.tests.items.size() == 17);
  CHECK(all.tests.family == 17);
  for (const PairedItemResult& item : all.tests.items) {
    CHECK(item.pairs.front().test.v == 6);
    CHECK(item.pairs.front().p == Approx(2.0 / 8));
    CHECK(item.pairs.front().p_holm == 1);
    CHECK(item.pairs.front().p_bh == Approx(2.0 / 8));
  }
  const ExplorationResults& exploration = results.exploration;
  REQUIRE(exploration.choices.size() == 1);  // what is asked before the session is no result
  CHECK(exploration.choices.front().n == 3);
  CHECK(exploration.choices.front().options[0].k == 2);
  CHECK(exploration.choices.front().options[1].ci_low == Approx(0.008403759).epsilon(1e-6));  // R: binom.test(1, 3)
  REQUIRE(exploration.exposure.size() == 4);
  for (const Exposure& row : exploration.exposure) {
    CHECK(row.n == 3);
    CHECK(row.planned_s == 150);
    CHECK(row.mean_s == Approx(120));
    CHECK(row.shortest_s == 60);
    CHECK(row.ended_early == 1);
  }
  CHECK(std::count_if(results.questionnaire.items.begin(), results.questionnaire.items.end(),
                      [](const QuestionnaireItem& item) { return !item.paired; }) == 5);
  bool said = false;
  for (const std::string& one : results.deviations) said = said || one.find("ended early") != std::string::npos;
  CHECK(said);

  const std::string methods = methods_text(*study, experiment2(), results);
  CHECK(methods.find("17 items were answered for each condition") != std::string::npos);
  CHECK(methods.find("d'") == std::string::npos);
  std::map<std::string, std::string> files;
  for (const Block& block : result_blocks(results, experiment2())) files[block.id] = block.csv_rows();
  REQUIRE(files.size() == 8);  // ratings has the tests of the items, exposure the times; four compare them as outcomes
  CHECK(files.at("items").find("\nQB1,QB,It is easy to use.,C,,3,7,1,4.5158") != std::string::npos);
  CHECK(files.at("items").find(",7,6,8,0.75,1,9,") != std::string::npos);
  CHECK(files.at("choices").find(",wearing the devices,2,3,") != std::string::npos);
  CHECK(files.contains("ratings"));
  CHECK(files.contains("exposure"));
}

TEST_CASE("an exploration comes back from its event", "[data]") {
  const Protocol& protocol = experiment2();
  ExplorationRecord record = exploration_of(protocol, {3, 2, 0, 1, 150}, 2);
  record.duration_s = 12.5;
  record.ended_early = true;
  record.words = "tired";
  Presentation piece;
  piece.duration_s = 10;
  piece.ticks = 10000;
  piece.fingers.resize(2);
  piece.fingers[1].finger = 1;
  piece.fingers[1].contacts = 7;
  record.presentations = {piece, piece};
  const auto body = nlohmann::ordered_json::parse(body_text(to_body(record, Unit::n_per_m)));
  const ExplorationRecord back = exploration_from(body, Unit::n_per_m);
  CHECK(back.slot == record.slot);
  CHECK(back.attempt == 2);
  CHECK(back.condition == "C");
  CHECK(back.object == "teddy-bear");
  CHECK(back.devices);
  CHECK(back.ended_early);
  CHECK(back.words == "tired");
  REQUIRE(back.presentations.size() == 2);
  CHECK(back.presentations[1].fingers[1].contacts == 7);
}

TEST_CASE("the history of a log says which attempt comes next", "[data]") {
  const Protocol& protocol = experiment2();
  const ExplorationRecord first = exploration_of(protocol, {1, 1, 0, 0, 150}, 1);
  const ExplorationRecord second = exploration_of(protocol, {1, 1, 0, 0, 150}, 2);
  MemoryLog log;
  const auto began = [&](int attempt) {
    log.append(event_kind::kExplorationBegan, {{"index", 1}, {"attempt", attempt}}, {});
  };
  began(1);
  CHECK(replay(log.events()).exploration.pending == 1);
  log.append(event_kind::kExplorationVoided, voided_body(first, Unit::n_per_m, "interrupted", false, true), {});
  began(2);
  log.append(event_kind::kExplorationVoided, voided_body(second, Unit::n_per_m, "device_lost", true, false), {});
  const ExplorationHistory history = replay(log.events()).exploration;
  CHECK_FALSE(history.pending);
  CHECK(history.attempts.at(1) == 2);
  CHECK(history.used.at(1) == 1);
  CHECK(history.given_up.contains(1));
}

}  // namespace
}  // namespace jnd
