// The registered analysis and what stands beside it: tests, refusals, sensitivity, deviations, ratings, methods.
#include "data/results/study_results.h"

#include <cmath>

#include "data/blocks/result_blocks.h"
#include "data/methods/methods_text.h"
#include "data/results/rating_answers.h"
#include "tests/catch.h"
#include "tests/data/pair_results.h"
#include "tests/data/study_fixture.h"

namespace jnd {
namespace {

// Counts of one participant: hits and false alarms of 20 trials a class, by condition and series of chinello2017.
std::vector<CellCounts> participant_counts(const std::string& name, const std::array<std::array<int, 3>, 3>& hits,
                                           int false_alarms) {
  std::vector<CellCounts> cells;
  for (int condition = 0; condition < 3; ++condition)
    for (int series = 0; series < 3; ++series)
      cells.push_back(
          {name,
           condition,
           series,
           {20, hits[static_cast<std::size_t>(condition)][static_cast<std::size_t>(series)], 20, false_alarms}});
  return cells;
}

// Five participants; SV is best for everyone.
std::vector<CellCounts> group_counts() {
  std::vector<CellCounts> cells;
  for (int i = 0; i < 5; ++i)
    for (const CellCounts& cell :
         participant_counts("P0" + std::to_string(i + 1),
                            {{{15 + i % 2, 13, 10 + i % 3}, {12, 10 + i % 2, 8}, {19, 17 - i % 2, 14}}}, 3 + i % 2))
      cells.push_back(cell);
  return cells;
}

TEST_CASE("pairs are found among those of a comparison", "[data]") {
  CHECK(pair_of({0, 1}, 3).pair == 0);
  CHECK(pair_of({0, 2}, 3).pair == 1);
  CHECK(pair_of({1, 2}, 3).pair == 2);
  CHECK(pair_of({2, 1}, 3).pair == 2);
  CHECK(pair_of({2, 1}, 3).turned);
  CHECK_FALSE(pair_of({1, 2}, 3).turned);
  CHECK(pair_of({2, 3}, 4).pair == 5);
}

TEST_CASE("the registered tests run on the slope, and contrasts are Holm's over the registered ones", "[data]") {
  const StudyResults results = results_of(group_counts(), chinello());
  const OutcomeComparison& slope = results.comparisons.front();
  REQUIRE(slope.refused.empty());
  CHECK(slope.registered);
  CHECK(slope.outcome == "slope");
  CHECK(slope.table.n == 5);
  for (std::size_t row = 0; row < 5; ++row)
    for (std::size_t condition = 0; condition < 3; ++condition)
      CHECK(slope.table.at(row, condition) == value_of(results.task.estimates[row * 3 + condition], kSlope));
  const std::vector<double> p = contrast_p(slope.comparison, chinello().analysis);
  REQUIRE(p.size() == 3);
  // All three pairs are registered: the family is the comparison's own.
  for (std::size_t i = 0; i < 3; ++i) CHECK(p[i] == slope.comparison.pairs[i].t_p_holm);
  Protocol one = chinello();
  one.analysis.contrasts = {{2, 0}};
  CHECK(contrast_p(slope.comparison, one.analysis)[0] == slope.comparison.pairs[1].t.p);
  one.analysis.tests.post_hoc = PostHoc::tukey;
  CHECK(contrast_p(slope.comparison, one.analysis)[0] == slope.comparison.pairs[1].tukey.p);
  one.analysis.tests.omnibus = Omnibus::friedman;
  CHECK(omnibus_p(slope.comparison, one.analysis) == slope.comparison.friedman.p);
  one.analysis.tests.omnibus = Omnibus::none;
  CHECK(std::isnan(omnibus_p(slope.comparison, one.analysis)));
}

TEST_CASE("a row of the contrasts is on one scale; the registered one has the registered p too", "[data]") {
  Protocol protocol = chinello();
  protocol.analysis.contrasts = {{2, 0}};
  const StudyResults results = results_of(group_counts(), protocol);
  const std::vector<ContrastRow>& rows = results.contrasts;
  REQUIRE(rows.size() == 2);
  const PairComparison& pair = results.comparisons.front().comparison.pairs[1];  // 0 - 2
  CHECK(rows[0].outcome == "slope");
  CHECK(rows[0].unit == "per N/m");
  CHECK(rows[0].registered);
  CHECK(rows[0].difference.n == 5);
  CHECK(rows[0].difference.mean == Approx(-pair.mean_difference));
  CHECK(rows[0].difference.ci_low == Approx(-pair.t.ci_high));
  CHECK(rows[0].p == Approx(pair.t.p).epsilon(1e-12));
  CHECK(rows[0].p_registered == pair.t.p);  // of one contrast there is nothing to correct
  CHECK(rows[1].outcome == "jnd");
  CHECK(rows[1].unit == "N/m");
  CHECK(rows[1].difference.mean ==
        Approx(group_of(results.task, 2, kJnd).mean.mean - group_of(results.task, 0, kJnd).mean.mean));
  CHECK(rows[1].p < 0.05);
  CHECK(std::isnan(rows[1].p_registered));

  protocol.analysis.tests.outcome = Outcome::jnd;
  const StudyResults on_jnd = results_of(group_counts(), protocol);
  const std::vector<ContrastRow>& one = on_jnd.contrasts;
  REQUIRE(one.size() == 1);
  CHECK(one[0].registered);
  CHECK(one[0].difference.mean == rows[1].difference.mean);
  CHECK(one[0].p == rows[1].p);
  CHECK(std::isfinite(one[0].p_registered));
}

TEST_CASE("who has no value in one condition is missing from its contrasts, and from no others", "[data]") {
  Protocol protocol = chinello();
  protocol.analysis.contrasts = {{0, 1}, {2, 0}};
  protocol.analysis.tests.outcome = Outcome::jnd;
  std::vector<CellCounts> cells = group_counts();
  const std::string who = cells.front().participant;
  for (CellCounts& cell : cells)
    if (cell.participant == who && cell.condition == 2) cell.counts = {20, 2, 20, 10};  // more false alarms than hits
  const StudyResults results = results_of(cells, protocol);
  const OutcomeComparison& outcome = results.comparisons.front();
  REQUIRE(outcome.left_out.size() == 1);
  CHECK_FALSE(outcome.refused.empty());  // the test over all conditions
  const std::vector<ContrastRow>& rows = results.contrasts;
  REQUIRE(rows.size() == 2);
  CHECK(rows[0].refused.empty());
  CHECK(rows[0].difference.n == 5);
  CHECK(std::isfinite(rows[0].p_registered));
  CHECK_FALSE(rows[1].refused.empty());
  CHECK(rows[1].participants == 5);
  CHECK(rows[1].difference.n == 4);
  CHECK(std::isnan(rows[1].p_registered));
}

TEST_CASE("a method that has a value for nobody has a status as its median", "[data]") {
  std::vector<CellCounts> cells;
  for (const char* name : {"P01", "P02", "P03"})
    for (const CellCounts& cell : participant_counts(name, {{{20, 20, 20}, {20, 20, 20}, {20, 20, 20}}}, 0))
      cells.push_back(cell);
  const StudyResults results = results_of(cells, chinello());
  bool found = false;
  for (const SensitivityRow& row : results.sensitivity) {
    if (row.method.method != JndMethod::least_squares || row.method.correction != Correction::none) continue;
    found = true;
    CHECK(row.n == 0);
    REQUIRE(row.group.size() == 3);
    for (const TaskGroupRow& one : row.group) {
      CHECK(one.middle == Beyond::below);
      CHECK(std::isnan(one.median));
    }
  }
  CHECK(found);
}

TEST_CASE("tests on the JND are refused where somebody has none, by name; the slope keeps everybody", "[data]") {
  std::vector<CellCounts> cells = group_counts();
  for (CellCounts& cell : cells)
    if (cell.participant == "P02" && cell.condition == 1) cell.counts = {20, 3, 20, 9};
  Protocol protocol = chinello();
  protocol.analysis.tests.outcome = Outcome::jnd;
  const StudyResults refused = results_of(cells, protocol);
  const OutcomeComparison& jnd = refused.comparisons.front();
  CHECK(jnd.refused.find("P02 (V: no_sensitivity)") != std::string::npos);
  REQUIRE(refused.deviations.size() == 1);
  CHECK(refused.deviations[0].find("refused") != std::string::npos);
  for (const SensitivityRow& row : refused.sensitivity) CHECK_FALSE(row.same_conclusion);

  const StudyResults kept = results_of(cells, chinello());
  CHECK(kept.comparisons.front().table.n == 5);
  CHECK(kept.comparisons.front().refused.empty());
  CHECK(kept.deviations.empty());
  bool said = false;
  for (const std::string& caution : kept.cautions) said = said || caution.find("1 of 15") != std::string::npos;
  CHECK(said);
}

TEST_CASE("a sensitivity row is the registered analysis under another method", "[data]") {
  const StudyResults results = results_of(group_counts(), chinello());
  REQUIRE(results.sensitivity.size() == 11);
  const SensitivityRow& registered = results.sensitivity.front();
  CHECK(registered.registered);
  CHECK(registered.same_conclusion);
  CHECK(registered.omnibus_p == omnibus_p(results.comparisons.front().comparison, chinello().analysis));
  for (const SensitivityRow& row : results.sensitivity) {
    Protocol other = chinello();
    other.analysis.model = row.method.model;
    other.analysis.correction = std::string(to_string(row.method.correction));
    const std::string method(to_string(row.method.method));
    other.analysis.jnd_method = method.starts_with("ml_")               ? "ml"
                                : method == "least_squares_independent" ? "least_squares"
                                                                        : method;
    other.analysis.common_criterion = method.ends_with("_common");
    const TaskResults again = results_of_counts(group_counts(), other, SessionKind::real);
    CAPTURE(describe(row.method));
    for (std::size_t condition = 0; condition < 3; ++condition) {
      const TaskGroupRow& expected = group_of(again, static_cast<int>(condition), kJnd);
      CHECK(row.group[condition].median == expected.median);
      CHECK(row.group[condition].mean.n == expected.mean.n);
    }
    // Every participant is best with SV, whatever the model.
    CHECK(row.group[2].median < row.group[0].median);
    CHECK(row.group[2].median < row.group[1].median);
  }
}

TEST_CASE("condition by series leaves out who has no finite d' in a cell", "[data]") {
  std::vector<CellCounts> cells = group_counts();
  cells[0].counts = {0, 0, 20, 3};
  const StudyResults results = results_of(cells, chinello());
  CHECK(results.by_series.n == 4);
  REQUIRE(results.by_series.left_out.size() == 1);
  CHECK(results.by_series.left_out[0].participant == "P01");
  CHECK(results.by_series.left_out[0].reason.find("missing") != std::string::npos);
  CHECK(results.by_series.test.b.effect.df1 == 2);
  CHECK(results.by_series.test.ab.effect.df1 == 4);
}

TEST_CASE("a study's results hold ratings, times and the manner of answering", "[data]") {
  const TemporaryFolder folder;
  const auto study = new_study(folder / "study.jnd");
  const Question* rating = nullptr;
  for (const Question& question : tutorial().questions)
    if (question.kind == Question::Kind::rating && question.per_condition) rating = &question;
  REQUIRE(rating != nullptr);
  for (int number = 1; number <= 3; ++number) {
    const NewSession session = new_session(number);
    const auto log = study->open_session(session);
    answer_all(*log, tutorial(), number);
    for (std::size_t i = 0; i < tutorial().conditions.size(); ++i)
      log->append(
          event_kind::kQuestionAnswered,
          question_body(*rating, tutorial().conditions[i].name, std::to_string(number + static_cast<int>(i)), 0),
          {9, 9});
    study->close_session(session.id, {10, 10});
  }
  const StudyResults results = results_of(*study, tutorial(), SessionKind::simulated);
  const OutcomeComparison& last = results.comparisons.back();
  CHECK(last.question);
  CHECK(last.outcome == rating->id);
  CHECK(last.table.at(2, 1) == 4);
  CHECK(results.comparisons[1].outcome == "trial_time");
  REQUIRE(results.questionnaire.tests.items.size() == 1);
  CHECK(results.questionnaire.tests.items[0].conditions[0].median == 2);
  CHECK(results.behaviour.participants.size() == 3);
  CHECK(results.behaviour.conditions.size() == tutorial().conditions.size());
  int trials = 0;
  for (const BehaviourRow& row : results.behaviour.participants) trials += row.bias.said_different.n;
  CHECK(trials == 3 * 16);  // practice is not counted

  const std::string text = methods_text(*study, tutorial(), results);
  for (const std::string& part : {tutorial().sha256, std::to_string(kSeed), results.attendance.heads[2].hash,
                                  std::string("least-squares line"), std::string("simulated data")})
    CHECK(text.find(part) != std::string::npos);
  CHECK(text.back() == '\n');
  CHECK(text == methods_text(*study, tutorial(), results_of(*study, tutorial(), SessionKind::simulated)));
}

TEST_CASE("answers to questions of kind number have a mean, an interval and the comparison of a rating", "[data]") {
  Protocol protocol = tutorial();
  protocol.questions.clear();
  Question guess;
  guess.when = Question::When::after_session;
  guess.kind = Question::Kind::number;
  guess.id = "guess";
  guess.text = "How much stiffer, in percent?";
  guess.max = 1000;
  guess.per_condition = true;
  Question age = guess;
  age.when = Question::When::before_session;
  age.id = "age";
  age.per_condition = false;
  protocol.questions = {guess, age};
  const TemporaryFolder folder;
  const auto study = new_study(folder / "study.jnd", protocol);
  for (int number = 1; number <= 3; ++number) {
    const NewSession session = new_session(number);
    const auto log = study->open_session(session);
    for (std::size_t i = 0; i < protocol.conditions.size(); ++i)
      log->append(event_kind::kQuestionAnswered,
                  question_body(guess, protocol.conditions[i].name,
                                std::to_string(100 * number + static_cast<int>(i) * number), 0),
                  {9, 9});
    log->append(event_kind::kQuestionAnswered, question_body(age, "", std::to_string(20 + number), 0), {9, 9});
  }
  const StudyResults results = results_of(*study, protocol, SessionKind::simulated);
  REQUIRE(results.questionnaire.items.size() == 2);
  CHECK(results.questionnaire.items[0].paired);
  CHECK(results.questionnaire.items[0].scores[0].mean.mean == Approx(200));
  CHECK(results.questionnaire.items[0].scores[0].mean.ci_low == Approx(200 - 248.4138).epsilon(1e-5));
  CHECK_FALSE(results.questionnaire.items[0].scores[0].sides);
  CHECK(results.questionnaire.items[1].scores[0].mean.mean == Approx(22));
  REQUIRE(results.questionnaire.tests.items.size() == 1);
  CHECK(results.questionnaire.tests.items[0].pairs[0].test.n == 3);
  CHECK(results.comparisons.back().outcome == "guess");
  CHECK(results.comparisons.back().refused.empty());
  const std::vector<Block> blocks = result_blocks(results, protocol);
  const Block* const items = block_named(blocks, "items");
  REQUIRE(items != nullptr);
  CHECK(items->text(items->rows() - 1, "item") == "age");
}

TEST_CASE("departing from the registered axis and unfinished sessions are deviations", "[data]") {
  const TemporaryFolder folder;
  const auto study = new_study(folder / "study.jnd");
  const NewSession session = new_session(1);
  const auto log = study->open_session(session);
  answer_all(*log, tutorial(), 1);
  const StudyResults results =
      results_of(*study, tutorial(), SessionKind::simulated, {.by = DifferenceSource::delivered});
  REQUIRE(results.deviations.size() >= 2);
  CHECK(results.deviations[0].find("over delivered ones") != std::string::npos);
  CHECK(results.deviations[1].find("not finished") != std::string::npos);
  CHECK(results.comparisons.front().refused.find("at least 2") != std::string::npos);
}

}  // namespace
}  // namespace jnd
