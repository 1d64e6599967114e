// Results of groups, questionnaires and cues together, and answers taken back.
#include "data/results/questionnaire_results.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/group/p_adjust.h"
#include "analysis/group/post_hoc.h"
#include "analysis/numerics/special_values.h"
#include "data/blocks/result_blocks.h"
#include "data/log/exploration_body.h"
#include "data/log/replay.h"
#include "data/methods/methods_text.h"
#include "data/results/cue_combination.h"
#include "data/results/study_results.h"
#include "protocols/planning/allotment.h"
#include "tests/catch.h"
#include "tests/data/exploration_fixture.h"
#include "tests/data/pair_results.h"
#include "tests/data/study_fixture.h"

namespace jnd {
namespace {

// Questionnaires of free interaction: tests against numbers computed by hand, choices and times out of a log.

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

// Groups of participants in the results: who has rows, what is compared, and what is refused.

Protocol grouped(std::vector<int> of_old, BetweenTest between) {
  Protocol protocol = chinello();
  protocol.groups = {{"young", "under 30", {0, 1, 2}}, {"old", "over 60", std::move(of_old)}};
  protocol.analysis.tests.between = between;
  protocol.analysis.contrasts = {{0, 1}, {2, 0}};
  return protocol;
}

// So many participants of each group in turn; hits differ from one to the next, and the old have fewer.
std::vector<CellCounts> grouped_counts(const Protocol& protocol, int each) {
  std::vector<CellCounts> cells;
  for (int i = 0; i < 2 * each; ++i) {
    const int group = i % 2;
    for (const int condition : conditions_of(protocol, group))
      for (int series = 0; series < 3; ++series)
        cells.push_back({"P0" + std::to_string(i + 1),
                         condition,
                         series,
                         {20, 18 - 3 * group - (i * (condition + 3)) % 5 - 2 * series, 20, 3 + (i + condition) % 2},
                         group});
  }
  return cells;
}

StudyResults results_for(const Protocol& protocol, int each = 4) {
  return results_of(grouped_counts(protocol, each), protocol);
}

double mean_slope(const StudyResults& results, const std::string& participant) {
  double sum = 0;
  int n = 0;
  for (const TaskEstimateRow& row : results.task.estimates) {
    if (row.participant != participant) continue;
    sum += value_of(row, kSlope);
    ++n;
  }
  return sum / n;
}

TEST_CASE("nobody has a row of a condition that the group does not get", "[groups]") {
  const Protocol protocol = grouped({0, 1}, BetweenTest::welch);
  const StudyResults results = results_for(protocol);
  const TaskResults& task = results.task;
  CHECK(task.estimates.size() == 4 * 3 + 4 * 2);
  CHECK(task.cells.size() == 3 * task.estimates.size());
  for (const TaskEstimateRow& row : task.estimates) CHECK(has_condition(protocol, row.group, row.condition));
  CHECK(group_of(task, 0, kJnd).participants == 8);
  CHECK(group_of(task, 2, kJnd).participants == 4);
  const OutcomeComparison& outcome = results.comparisons.front();
  CHECK_FALSE(outcome.crossed);
  CHECK(outcome.everyone.size() == 8);
  CHECK(outcome.table.n == 4);  // the young, who get them all
  CHECK(outcome.left_out.empty());
  CHECK(results.by_series.n == 4);
}

TEST_CASE("welch and mann-whitney compare participants' means over their conditions", "[groups]") {
  for (const BetweenTest test : {BetweenTest::welch, BetweenTest::mann_whitney}) {
    const Protocol protocol = grouped({0, 1}, test);
    const StudyResults results = results_for(protocol);
    std::vector<double> young, old;
    for (int i = 1; i <= 8; ++i) (i % 2 == 1 ? young : old).push_back(mean_slope(results, "P0" + std::to_string(i)));
    const GroupsCompared& groups = results.groups.value();
    REQUIRE(groups.tested());
    REQUIRE(groups.comparison.pairs.size() == 1);
    CHECK(groups.comparison.pairs[0].welch.p == Approx(welch_t(young, old).p).epsilon(1e-12));
    CHECK(groups.comparison.pairs[0].welch.p < 0.05);
    CHECK(groups.comparison.pairs[0].ranks.p == Approx(mann_whitney(young, old).p).epsilon(1e-12));
    // By group: each of its conditions, then their mean.
    REQUIRE(groups.means.size() == 4 + 3);
    CHECK(groups.means[3].condition == -1);
    CHECK(groups.means[3].mean.mean == Approx(mean_with_ci(young).mean).epsilon(1e-12));
    CHECK(groups.means[6].mean.mean == Approx(mean_with_ci(old).mean).epsilon(1e-12));
    CHECK(groups.means[6].participants == 4);
  }
}

TEST_CASE("mixed-anova has every condition of both groups", "[groups]") {
  const StudyResults results = results_for(grouped({0, 1, 2}, BetweenTest::mixed_anova));
  const GroupsCompared& groups = results.groups.value();
  REQUIRE(groups.tested());
  CHECK(results.comparisons.front().crossed);
  CHECK(groups.table.values.k == 3);
  CHECK(groups.table.values.values == results.comparisons.front().table.values);
  const MixedAnova expected = mixed_anova(groups.table);
  CHECK(groups.comparison.anova.group.p == expected.group.p);
  CHECK(groups.comparison.anova.interaction.df1 == 2);
  CHECK(groups.comparison.anova.interaction.df2 == 12);
}

TEST_CASE("a contrast rests on those who get both conditions, corrected over the contrasts", "[groups]") {
  Protocol protocol = grouped({0, 1}, BetweenTest::welch);
  const StudyResults results = results_for(protocol);
  const OutcomeComparison& outcome = results.comparisons.front();
  std::vector<double> p;
  for (const Contrast& contrast : protocol.analysis.contrasts) {
    std::vector<double> a, b;
    for (const ParticipantValues& one : outcome.everyone) {
      if (!has_condition(protocol, one.group, contrast.a) || !has_condition(protocol, one.group, contrast.b)) continue;
      a.push_back(one.values[static_cast<std::size_t>(contrast.a)]);
      b.push_back(one.values[static_cast<std::size_t>(contrast.b)]);
    }
    p.push_back(paired_t(a, b).p);
  }
  const std::vector<ContrastRow>& rows = results.contrasts;
  REQUIRE(rows.size() == 4);  // each on the slope, and the JND beside it
  CHECK(rows[0].participants == 8);
  CHECK(rows[0].difference.n == 8);
  CHECK(rows[2].participants == 4);
  CHECK(rows[2].difference.n == 4);
  CHECK(rows[0].p_registered == Approx(holm(p)[0]).epsilon(1e-12));
  CHECK(rows[2].p_registered == Approx(holm(p)[1]).epsilon(1e-12));
  protocol.analysis.tests.post_hoc = PostHoc::tukey;
  CHECK(contrasts_within(outcome, protocol)[0].refused.find("Tukey") == 0);
  CHECK(std::isnan(contrasts_within(outcome, protocol)[0].p));
}

TEST_CASE("what cannot be compared says why", "[groups]") {
  SECTION("a JND of everyone is needed, and the means say who has one") {
    Protocol protocol = grouped({0, 1}, BetweenTest::welch);
    protocol.analysis.tests.outcome = Outcome::jnd;
    std::vector<CellCounts> cells = grouped_counts(protocol, 4);
    for (CellCounts& cell : cells)
      if (cell.participant == "P02" && cell.condition == 0) cell.counts = {20, 2, 20, 10};
    const StudyResults results = results_of(cells, protocol);
    const GroupsCompared& groups = results.groups.value();
    CHECK_FALSE(groups.tested());
    CHECK(groups.refused.find("P02 (S: no_sensitivity)") != std::string::npos);
    CHECK(groups.means[4].mean.n == 3);
    CHECK(groups.means[4].participants == 4);
    CHECK(results.deviations.back().find("groups was refused") != std::string::npos);
  }
  SECTION("one group alone") {
    const Protocol protocol = grouped({0, 1}, BetweenTest::welch);
    std::vector<CellCounts> cells = grouped_counts(protocol, 4);
    std::erase_if(cells, [](const CellCounts& cell) { return cell.group == 1; });
    const StudyResults results = results_of(cells, protocol);
    CHECK(results.groups->refused == "fewer than two groups have a participant");
    CHECK(std::isnan(results.groups->means.back().mean.mean));
  }
  SECTION("one participant in each group has no variance, which the test's status says") {
    const StudyResults results = results_for(grouped({0, 1}, BetweenTest::welch), 1);
    REQUIRE(results.groups->tested());
    CHECK(results.groups->comparison.pairs[0].welch.status == StatisticStatus::too_few);
    CHECK(std::isnan(results.groups->comparison.pairs[0].welch.p));
  }
  SECTION("nobody gets every condition") {
    Protocol protocol = grouped({0, 1}, BetweenTest::welch);
    protocol.groups[0].conditions = {0, 2};
    const StudyResults results = results_for(protocol);
    CHECK(results.comparisons.front().refused.find("groups of participants get different conditions") == 0);
    CHECK(results.groups->tested());
    CHECK(std::isfinite(results.contrasts[0].p_registered));  // of the old
  }
}

TEST_CASE("files have the group and its test where there are groups, and nothing of them elsewhere", "[groups]") {
  const auto names = [](const StudyResults& results, const Protocol& protocol) {
    std::vector<std::string> found;
    for (const Block& block : result_blocks(results, protocol)) found.push_back(block.file());
    return found;
  };
  const Protocol protocol = grouped({0, 1}, BetweenTest::welch);
  const auto with = names(results_for(protocol), protocol);
  CHECK(std::count(with.begin(), with.end(), "groups.csv") == 1);
  CHECK(std::count(with.begin(), with.end(), "group_pairs.csv") == 1);
  const Protocol mixed = grouped({0, 1, 2}, BetweenTest::mixed_anova);
  const auto effects = names(results_for(mixed), mixed);
  CHECK(std::count(effects.begin(), effects.end(), "between.csv") == 1);
  Protocol none = protocol;
  none.groups.clear();
  std::vector<CellCounts> cells = grouped_counts(grouped({0, 1, 2}, BetweenTest::welch), 4);
  for (CellCounts& cell : cells) cell.group.reset();
  const auto without = names(results_of(cells, none), none);
  CHECK(std::count(without.begin(), without.end(), "groups.csv") == 0);
}

// Cues together against an optimal combination of them: against numbers computed by hand.

Protocol with_cues(const std::vector<Cues>& cues) {
  Protocol protocol;
  for (const Cues& one : cues) {
    Condition condition;
    condition.cues = one;
    protocol.conditions.push_back(condition);
  }
  return protocol;
}

TaskEstimateRow row(const std::string& participant, int condition, std::optional<double> jnd) {
  TaskEstimateRow result;
  result.participant = participant;
  result.condition = condition;
  result.estimates.values = {{.value = jnd}};
  return result;
}

TaskResults results(std::vector<TaskEstimateRow> rows = {}) {
  TaskResults all;
  all.outcomes = {{.key = "jnd", .title = "JND"}};
  all.estimates = std::move(rows);
  return all;
}

constexpr Cues kS{.force = true}, kV{.vibration = true}, kSV{.force = true, .vibration = true};

bool near(double a, double b) {
  return std::abs(a - b) <= 1e-12 * std::abs(b);
}

TEST_CASE("JNDs of independent cues combine as a right angle's height") {
  CHECK(near(optimal_jnd(300, 400), 240));  // 1/300^2 + 1/400^2 = 1/240^2
  CHECK(near(optimal_jnd(200, 200), 200 / std::sqrt(2.0)));
  CHECK(near(optimal_jnd(1e-200, 1), 1e-200));
  CHECK(near(optimal_jnd(1e150, 1e150), 1e150 / std::sqrt(2.0)));
}

TEST_CASE("each participant's JND of both cues stands beside the combination of theirs alone") {
  const TaskResults jnds =
      results({row("P01", 0, 300), row("P01", 1, 400), row("P01", 2, 240), row("P02", 0, 300), row("P02", 1, 400),
               row("P02", 2, 480), row("P03", 0, 300), row("P03", 1, std::nullopt), row("P03", 2, 250),
               row("P04", 0, 300), row("P04", 1, 400), row("P04", 2, std::nullopt)});
  const std::vector<CueCombination> found = cue_combinations(jnds, with_cues({kS, kV, kSV}));
  REQUIRE(found.size() == 1);
  CHECK(found[0].a == 0);
  CHECK(found[0].b == 1);
  CHECK(found[0].both == 2);
  REQUIRE(found[0].participants.size() == 4);
  CHECK(near(*found[0].participants[0].predicted, 240));
  CHECK(near(*found[0].participants[1].observed, 480));
  CHECK_FALSE(found[0].participants[2].predicted.has_value());
  CHECK(found[0].participants[2].observed.has_value());
  CHECK_FALSE(found[0].participants[3].observed.has_value());
  // ln 1 and ln 2: mean .34657, sd .49013, t(1) = 12.7062.
  CHECK(found[0].log_ratio.n == 2);
  CHECK(std::abs(found[0].log_ratio.mean - 0.346574) < 1e-6);
  CHECK(std::abs(found[0].log_ratio.ci_high - (0.346574 + 12.706205 * 0.490129 / std::sqrt(2.0))) < 1e-4);
}

TEST_CASE("only conditions whose cues are those of two others together are combined") {
  CHECK(cue_combinations(results(), with_cues({kS, kV})).empty());
  CHECK(cue_combinations(results(), with_cues({kS, kSV, kSV})).empty());  // they share force
  CHECK(cue_combinations(results(), with_cues({Cues{}, kS, kS})).empty());
  CHECK(cue_combinations(results(), with_cues({kSV, kS, kV})).size() == 1);
  CHECK(cue_combinations(results(), with_cues({kS, kV, kSV, kSV})).size() == 2);
  CHECK(cue_combinations(results(),
                         with_cues({{.force = true}, {.kinaesthetic = true}, {.force = true, .kinaesthetic = true}}))
            .size() == 1);
}

}  // namespace
}  // namespace jnd
