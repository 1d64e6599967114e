// The hierarchical model of a study: that of its counts, with a status for whatever it does not say.
#include "data/results/study_hierarchical.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "analysis/group/p_adjust.h"
#include "data/blocks/result_blocks.h"
#include "data/results/study_results.h"
#include "data/study/study_admin.h"
#include "protocols/reading/protocol_json.h"
#include "tests/catch.h"
#include "tests/data/pair_results.h"
#include "tests/data/study_fixture.h"

namespace jnd {
namespace {

// Twelve trials a class and cell; people and conditions differ, in a fixed pattern.
std::vector<CellCounts> patterned_counts(int people) {
  std::vector<CellCounts> cells;
  for (int person = 0; person < people; ++person)
    for (int condition = 0; condition < 3; ++condition)
      for (int series = 0; series < 3; ++series) {
        const int hits = 8 - 2 * series + (person + condition) % 3 - (condition == 1 ? 1 : 0) + person % 2;
        cells.push_back({"P" + std::to_string(10 + person),
                         condition,
                         series,
                         {12, std::min(hits, 12), 12, (person + 2 * series + condition) % 4}});
      }
  return cells;
}

StudyHierarchical model_of(const std::vector<CellCounts>& cells, const Protocol& protocol = chinello()) {
  return study_hierarchical(results_of_counts(cells, protocol, SessionKind::simulated), protocol);
}

TEST_CASE("the model of a study is that of its counts", "[data][long]") {
  const std::vector<CellCounts> counts = patterned_counts(6);
  const TaskResults task = results_of_counts(counts, chinello(), SessionKind::simulated);
  const StudyHierarchical model = study_hierarchical(task, chinello());
  REQUIRE(model.status == HierarchicalStatus::ok);
  CHECK(model.reason.empty());
  CHECK(model.response == ResponseModel::yes_no);
  CHECK(model.participants == 6);
  CHECK(model.trials == 6 * 9 * 24);

  std::vector<HierarchicalCell> cells;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const CellCounts& one = counts[i];
    const std::array<double, 2>& pair = chinello().series[static_cast<std::size_t>(one.series)].pair;
    const int person = static_cast<int>(i / 9);
    const auto number = [](int count) { return static_cast<double>(count); };
    cells.push_back({person, one.condition, std::abs(pair[1] - pair[0]), number(one.counts.hits),
                     number(one.counts.n_diff - one.counts.hits)});
    cells.push_back({person, one.condition, 0, number(one.counts.false_alarms),
                     number(one.counts.n_same - one.counts.false_alarms)});
  }
  HierarchicalAnalysis fitted(cells, {});
  const HierarchicalFit& fit = fitted.add_intervals();
  for (std::size_t c = 0; c < 3; ++c) {
    const HierarchicalCondition& one = model.conditions[c];
    CHECK(one.condition == static_cast<int>(c));
    CHECK(one.participants == 6);
    CHECK(one.status == SlopeStatus::ok);
    CHECK(status_word(model, one) == "ok");
    CHECK(one.jnd == Approx(std::exp(fit.conditions[c].mu)).epsilon(1e-9));
    CHECK(one.ci_low == Approx(std::exp(fit.conditions[c].ends.low)).epsilon(1e-9));
    CHECK(one.ci_high == Approx(std::exp(fit.conditions[c].ends.high)).epsilon(1e-9));
    CHECK(one.weber == Approx(one.jnd / 900));
    CHECK(one.criterion == Approx(fit.conditions[c].criterion).epsilon(1e-9));
  }
  const std::vector<PersonEstimate> people = fitted.people();
  REQUIRE(model.people.size() == 18);
  for (std::size_t i = 0; i < people.size(); ++i) {
    const HierarchicalPerson& one = model.people[i];
    CHECK(one.participant == task.estimates[i].participant);
    CHECK(one.status == ShrunkenStatus::ok);
    CHECK(one.jnd == Approx(std::exp(people[i].mean)).epsilon(1e-6));
    CHECK(one.criterion == Approx(people[i].criterion).epsilon(1e-9));
    CHECK(one.separate == value_of(task.estimates[i], kJnd));
    CHECK(one.alone == Approx(std::exp(people[i].alone)).epsilon(1e-9));
  }
  const std::vector<ConditionDifference> differences = fitted.differences();
  REQUIRE(model.ratios.size() == 3);
  for (std::size_t i = 0; i < differences.size(); ++i) {
    const HierarchicalRatio& one = model.ratios[i];
    CHECK(one.defined);
    CHECK(one.participants == 6);
    CHECK(one.a == static_cast<int>(differences[i].a));
    CHECK(one.b == static_cast<int>(differences[i].b));
    CHECK(one.ratio == Approx(std::exp(differences[i].difference)).epsilon(1e-9));
    CHECK(one.ratio == Approx(model.conditions[differences[i].a].jnd / model.conditions[differences[i].b].jnd));
    CHECK(one.ci_low == Approx(std::exp(differences[i].ends.low)).epsilon(1e-9));
    CHECK(one.p == Approx(differences[i].p).epsilon(1e-9));
  }
  REQUIRE(model.check);
  const PredictiveCheck check =
      predictive_check(cells, {}, fit.maximum.place, kPredictiveDraws, 1);  // in other cells, of the same answers
  REQUIRE(model.check->rows.size() == 3 * 4);
  for (std::size_t i = 0; i < check.rows.size(); ++i) {
    CHECK(model.check->rows[i].condition == i / 4);
    CHECK(model.check->rows[i].level == check.rows[i].level);
    CHECK(model.check->rows[i].share.observed == Approx(check.rows[i].share.observed));
    CHECK(model.check->rows[i].participants == 6);
  }
  CHECK(model.check->p == Approx(check.p).margin(0.02));
  CHECK(model.equal_df == 2);
  CHECK(model.equal_p == Approx(fit.p).epsilon(1e-9));
}

TEST_CASE("shrunken JNDs lie between what the answers alone say and the group", "[data][long]") {
  std::vector<CellCounts> counts = patterned_counts(8);
  for (std::size_t i = 0; i < 9; ++i) counts[i].counts = {12, 12 - static_cast<int>(i % 2), 12, 1};  // very fine
  for (std::size_t i = 9; i < 18; ++i) counts[i].counts = {12, 3 + static_cast<int>(i % 3), 12, 2};  // coarse
  const StudyHierarchical model = model_of(counts);
  REQUIRE(model.status == HierarchicalStatus::ok);
  REQUIRE(model.persons.status == SpreadStatus::ok);
  CHECK_FALSE(model.alike());
  for (const HierarchicalPerson& one : model.people) {
    const double group = model.conditions[static_cast<std::size_t>(one.condition)].jnd;
    if (one.participant == "P10") CHECK(one.jnd < group);
    if (one.participant == "P11") CHECK(one.jnd > group);
    if (one.alone_status == SlopeStatus::ok && one.participant == "P11") CHECK(one.jnd < one.alone);
    CHECK(one.ln_sd > 0);
  }
}

TEST_CASE("of one participant no spread is told", "[data]") {
  const StudyHierarchical model = model_of(patterned_counts(1));
  REQUIRE(model.status == HierarchicalStatus::ok);
  CHECK(model.participants == 1);
  for (const HierarchicalSpread* spread : {&model.persons, &model.by_condition, &model.criteria}) {
    CHECK(spread->status == SpreadStatus::not_identified);
    CHECK(std::isnan(spread->sd));
  }
  CHECK(model.people.front().jnd == model.conditions.front().jnd);
}

TEST_CASE("a condition without slope has no JND, ratio or shrunken JND, and the others have", "[data]") {
  std::vector<CellCounts> counts = patterned_counts(5);
  for (CellCounts& cell : counts)
    if (cell.condition == 1) cell.counts = {12, 3, 12, 4};
  const StudyHierarchical model = model_of(counts);
  REQUIRE(model.status == HierarchicalStatus::ok);
  CHECK(status_word(model, model.conditions[1]) == "no_sensitivity");
  CHECK(std::isnan(model.conditions[1].jnd));
  CHECK(std::isnan(model.conditions[1].weber));
  CHECK(model.conditions[0].status == SlopeStatus::ok);
  for (const HierarchicalRatio& one : model.ratios) {
    const bool without = one.a == 1 || one.b == 1;
    CHECK(one.defined == !without);
    CHECK(std::isnan(one.ratio) == without);
    CHECK(one.p >= 0);
    CHECK(one.p <= 1);
  }
  for (const HierarchicalPerson& one : model.people) {
    CHECK(one.status == (one.condition == 1 ? ShrunkenStatus::no_group_jnd : ShrunkenStatus::ok));
    CHECK(std::isnan(one.jnd) == (one.condition == 1));
  }
}

TEST_CASE("who and what has no trials is missing, and moves nobody else", "[data]") {
  std::vector<CellCounts> counts = patterned_counts(4);
  std::vector<CellCounts> others;
  for (CellCounts& cell : counts) {
    if (cell.condition == 2) cell.counts = {};
    if (cell.participant == "P11") cell.counts = {};
    if (cell.participant != "P11") others.push_back(cell);
  }
  const StudyHierarchical model = model_of(counts), without = model_of(others);
  REQUIRE(model.status == HierarchicalStatus::ok);
  CHECK(model.participants == 3);
  CHECK(status_word(model, model.conditions[2]) == "missing");
  CHECK(std::isnan(model.conditions[2].jnd));
  CHECK(model.conditions[2].participants == 0);
  REQUIRE(model.ratios.size() == 1);
  CHECK(model.ratios.front().participants == 3);
  CHECK(model.ratios.front().p == without.ratios.front().p);
  CHECK(model.conditions[0].jnd == without.conditions[0].jnd);
  REQUIRE(model.people.size() == 12);
  for (const HierarchicalPerson& one : model.people) {
    const bool missing = one.participant == "P11" || one.condition == 2;
    CHECK((one.status == ShrunkenStatus::missing) == missing);
    CHECK(std::isnan(one.jnd) == missing);
    CHECK(std::isnan(one.criterion) == missing);
  }
  CHECK(model.people.back().jnd != model.people.back().jnd);
  CHECK(model.people[9].jnd == without.people[6].jnd);
}

TEST_CASE("where there is no model the reason is said, and nothing is estimated", "[data]") {
  Protocol independent = load_protocol(std::string(JND_SOURCE_DIR) + "/protocols/adaptive-staircase.json");
  independent.analysis.model = "independent-observation";  // of a procedure
  TaskResults thresholds = empty_task_results(independent);
  thresholds.estimates.emplace_back().participant = "P01";
  const StudyHierarchical not_offered = study_hierarchical(thresholds, independent);
  CHECK(not_offered.status == HierarchicalStatus::not_offered);
  CHECK_FALSE(not_offered.response);
  CHECK(not_offered.reason == "there is none of the registered model of d', independent-observation");

  const StudyHierarchical many = model_of(patterned_counts(201));
  CHECK(many.status == HierarchicalStatus::too_many_people);
  CHECK(many.reason.find("jnd calc hierarchical") != std::string::npos);

  std::vector<CellCounts> nobody = patterned_counts(2);
  for (CellCounts& cell : nobody) cell.counts = {0, 0, 12, 3};
  const StudyHierarchical no_answers = model_of(nobody);
  CHECK(no_answers.status == HierarchicalStatus::no_answers);

  for (const StudyHierarchical* model : {&not_offered, &many, &no_answers}) {
    CHECK(model->ratios.empty());
    CHECK(model->variants.empty());
    CHECK(model->equal_df == 0);
    for (const HierarchicalCondition& one : model->conditions) {
      CHECK(status_word(*model, one) == word_of(kHierarchicalStatusWords, model->status));
      CHECK(std::isnan(one.jnd));
    }
    for (const HierarchicalPerson& one : model->people) CHECK(std::isnan(one.jnd));
  }
}

TEST_CASE("the differencing observer is that of a protocol which registers it", "[data]") {
  Protocol differencing = chinello();
  differencing.analysis.model = "differencing";
  differencing.analysis.jnd_method = "ml";
  const StudyHierarchical model = model_of(patterned_counts(4), differencing);
  REQUIRE(model.status == HierarchicalStatus::ok);
  CHECK(model.response == ResponseModel::differencing);
  CHECK(model.conditions.front().jnd != model_of(patterned_counts(4)).conditions.front().jnd);
}

TEST_CASE("somebody who judges each interval by itself takes equal stimuli by their series", "[data][long]") {
  Protocol independent = chinello();
  independent.analysis.model = "independent-observation";
  const std::vector<CellCounts> counts = patterned_counts(6);
  const StudyHierarchical model = model_of(counts, independent);
  REQUIRE(model.status == HierarchicalStatus::ok);
  CHECK(model.response == ResponseModel::independent);
  std::vector<HierarchicalCell> cells;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const auto& [n_diff, hits, n_same, false_alarms] = counts[i].counts;
    const int person = static_cast<int>(i / 9);
    const std::array<double, 2>& pair = independent.series[static_cast<std::size_t>(counts[i].series)].pair;
    const double difference = std::abs(pair[1] - pair[0]);
    cells.push_back(
        {person, counts[i].condition, difference, static_cast<double>(hits), static_cast<double>(n_diff - hits)});
    cells.push_back({person, counts[i].condition, -difference, static_cast<double>(false_alarms),
                     static_cast<double>(n_same - false_alarms)});
  }
  HierarchicalModel of;
  of.response = ResponseModel::independent;
  const HierarchicalFit fit = HierarchicalAnalysis(cells, of).fit();
  for (std::size_t c = 0; c < 3; ++c)
    CHECK(model.conditions[c].jnd == Approx(std::exp(fit.conditions[c].mu)).epsilon(1e-9));
}

// Of counts, as if a share of the answers to each level had come in the second half.
TaskResults with_halves(const std::vector<CellCounts>& counts, const Protocol& protocol) {
  TaskResults results = results_of_counts(counts, protocol, SessionKind::simulated);
  for (TaskEstimateRow& row : results.estimates) {
    std::vector<LevelCount> late = row.answers;
    for (std::size_t i = 0; i < late.size(); ++i) {
      LevelCount &first = row.answers[i], &second = late[i];
      const int trials = (first.positive + first.negative) / 2;
      second.second_half = true;
      // Of differences as few as there can be, or a third.
      second.positive = first.level > 0 ? std::max(first.positive / 3, first.positive - trials) : first.positive / 2;
      second.negative = trials - second.positive;
      first.positive -= second.positive;
      first.negative -= second.negative;
    }
    row.answers.insert(row.answers.end(), late.begin(), late.end());
  }
  return results;
}

const HierarchicalVariant& variant_of(const StudyHierarchical& model, VariantKind kind) {
  const auto found = std::find_if(model.variants.begin(), model.variants.end(),
                                  [kind](const HierarchicalVariant& one) { return one.kind == kind; });
  if (found == model.variants.end()) throw std::runtime_error("no such variant");
  return *found;
}

TEST_CASE("what the model leaves out stands beside it, and changes nothing of it", "[data][long]") {
  const StudyHierarchical alone = model_of(patterned_counts(6));
  TaskResults task = with_halves(patterned_counts(6), chinello());
  const StudyHierarchical model = study_hierarchical(task, chinello());
  REQUIRE(model.variants.size() == 3);  // nobody was asked how sure they were
  for (std::size_t c = 0; c < 3; ++c) CHECK(model.conditions[c].jnd == Approx(alone.conditions[c].jnd).epsilon(1e-9));
  const HierarchicalVariant& drift = variant_of(model, VariantKind::drift);
  REQUIRE(drift.shared.size() == 2);
  CHECK(drift.shared[0].parameter == SharedParameter::drift_ln_s);
  CHECK(drift.shared[0].status == SharedStatus::ok);
  CHECK(drift.shared[0].value > 0);  // fewer hits in the second half: a larger JND
  CHECK(drift.shared[0].p < 0.05);
  CHECK(drift.conditions[0].status == SlopeStatus::ok);
  CHECK(drift.conditions[0].ci_low < drift.conditions[0].jnd);
  CHECK(drift.conditions[0].jnd != model.conditions[0].jnd);
  // Of counts alone nobody knows when they were answered.
  const HierarchicalVariant& unknown = variant_of(alone, VariantKind::drift);
  CHECK(unknown.shared[0].status == SharedStatus::not_identified);
  CHECK(std::isnan(unknown.shared[0].value));
  REQUIRE(unknown.conditions.size() == 3);
  CHECK(unknown.conditions[0].status == SlopeStatus::missing);
  // The other variants do not see the halves.
  for (const VariantKind kind : {VariantKind::overdispersion, VariantKind::lapse}) {
    const HierarchicalVariant &with = variant_of(model, kind), &without = variant_of(alone, kind);
    CHECK(with.shared[0].status == without.shared[0].status);
    CHECK(with.shared[0].ends.high == Approx(without.shared[0].ends.high).margin(1e-6));
    CHECK(with.conditions[2].jnd == Approx(without.conditions[2].jnd).epsilon(1e-5));
    CHECK(std::isnan(with.conditions[2].ci_high) == std::isnan(without.conditions[2].ci_high));
  }
  for (TaskEstimateRow& row : task.estimates)
    for (LevelCount& one : row.answers) {
      const int trials = one.positive + one.negative;
      one.sure_positive = one.positive / (one.level > 0 ? 2 : 3);
      one.sure_negative = (one.level > 0 ? trials * 2 / 3 : trials / 2) - one.sure_positive;
    }
  const StudyHierarchical graded = study_hierarchical(task, chinello());
  REQUIRE(graded.variants.size() == 4);
  CHECK(graded.conditions[0].jnd == model.conditions[0].jnd);
  const HierarchicalVariant& sureness = variant_of(graded, VariantKind::sureness);
  REQUIRE(sureness.shared.size() == 2);
  for (const SharedEstimate& one : sureness.shared) {
    CHECK(one.status == SharedStatus::ok);
    CHECK(one.value > 0);
    CHECK(std::isnan(one.p));
  }
}

TEST_CASE("delivered differences are those of the cells, near enough", "[data][long]") {
  TaskResults task = results_of_counts(patterned_counts(6), chinello(), SessionKind::simulated);
  const StudyHierarchical nominal = study_hierarchical(task, chinello());
  for (CellResult& cell : task.cells) cell.difference_source = DifferenceSource::delivered;
  std::size_t place = 0;
  for (TaskEstimateRow& row : task.estimates)
    for (LevelCount& one : row.answers)
      if (one.level > 0) one.level *= 0.8 + 1e-4 * static_cast<double>(place++ % 7);
  const StudyHierarchical delivered = study_hierarchical(task, chinello());
  REQUIRE(delivered.status == HierarchicalStatus::ok);
  CHECK_FALSE(delivered.check);
  for (std::size_t c = 0; c < 3; ++c)
    CHECK(delivered.conditions[c].jnd == Approx(0.8 * nominal.conditions[c].jnd).epsilon(5e-3));
}

TEST_CASE("what the registered rules leave out is not in the model either", "[data]") {
  const TemporaryFolder folder;
  const auto study = new_study(folder / "study.jnd", chinello());
  for (int number = 1; number <= 3; ++number) run_whole_session(*study, chinello(), number);
  Protocol protocol = chinello();
  protocol.analysis.exclude.response_time_above_s = 1.2;  // those of the trials behind the 70th
  exclude_participant(*study, "P02", SessionKind::simulated, "asleep", false, {1'700'000'999'000'000'000, 999});
  CHECK_FALSE(results_of(*study, protocol, SessionKind::simulated).hierarchical);  // nobody asked for it
  const StudyResults results = results_of(*study, protocol, SessionKind::simulated, {.hierarchical = true});
  REQUIRE(results.hierarchical);
  const StudyHierarchical& model = *results.hierarchical;
  std::int64_t counted = 0, excluded = 0;
  for (const CellResult& cell : results.task.cells) {
    counted += cell.counts.n_diff + cell.counts.n_same;
    excluded += cell.excluded;
  }
  CHECK(excluded > 0);
  CHECK(model.trials == counted);
  CHECK(model.participants == 2);
  for (const HierarchicalPerson& one : model.people) CHECK(one.participant != "P02");
}

TEST_CASE("registered contrasts of the model are its ratios, corrected by Holm, before the separate ones", "[data]") {
  Protocol protocol = chinello();
  protocol.analysis.hierarchical = true;
  protocol.analysis.contrasts = {{0, 1}, {2, 0}, {1, 2}};  // one of them turned
  const StudyResults results = results_of(patterned_counts(7), protocol);
  REQUIRE(results.hierarchical);  // nobody has to ask
  const StudyHierarchical& model = *results.hierarchical;
  Protocol plain = chinello();
  plain.analysis.contrasts = protocol.analysis.contrasts;
  const std::vector<ContrastRow> separate = results_of(patterned_counts(7), plain).contrasts;
  const std::vector<ContrastRow>& rows = results.contrasts;
  REQUIRE(rows.size() == separate.size() + 3);
  REQUIRE(rows.size() == 9);
  const std::array<const HierarchicalRatio*, 3> ratios = {&model.ratios[0], &model.ratios[1], &model.ratios[2]};
  const std::vector<double> p = holm(std::vector<double>{ratios[0]->p, ratios[1]->p, ratios[2]->p});
  for (std::size_t i = 0; i < 3; ++i) {
    const ContrastRow& row = rows[3 * i];
    CHECK(row.registered);
    CHECK(row.outcome == kHierarchicalScale);
    CHECK(row.participants == 7);
    CHECK(row.difference.n == 7);
    CHECK(row.p == ratios[i]->p);
    CHECK(row.p_registered == p[i]);
    CHECK(std::isnan(row.difference.sd));
    const double turned = i == 1 ? -1 : 1;
    CHECK(row.difference.mean == Approx(turned * std::log(ratios[i]->ratio)));
    CHECK(row.difference.ci_low < row.difference.mean);
    CHECK(row.difference.ci_high > row.difference.mean);
    for (const std::size_t other : {3 * i + 1, 3 * i + 2}) {
      CHECK_FALSE(rows[other].registered);
      CHECK(std::isnan(rows[other].p_registered));
      CHECK(rows[other].p == separate[other - i - 1].p);
      CHECK(rows[other].outcome == separate[other - i - 1].outcome);
      CHECK(rows[other].difference.mean == separate[other - i - 1].difference.mean);
    }
  }

  std::vector<CellCounts> nobody = patterned_counts(2);
  for (CellCounts& cell : nobody) cell.counts = {0, 0, 12, 3};
  const StudyResults refused = results_of(nobody, protocol);
  CHECK(refused.contrasts.size() == 9);
  for (const ContrastRow& row : refused.contrasts) {
    CHECK(std::isnan(row.p));
    CHECK(std::isnan(row.p_registered));
    CHECK(row.refused.empty() == !row.registered);
  }
}

TEST_CASE("blocks of the model are there where it was asked for, and say why there is none", "[data]") {
  const auto blocks_of = [](const StudyResults& results) {
    std::vector<Block> blocks = result_blocks(results, chinello());
    std::erase_if(blocks, [](const Block& block) { return !block.id.starts_with("hierarchical"); });
    return blocks;
  };
  CHECK(blocks_of(results_of(patterned_counts(5), chinello())).empty());
  const StudyResults results = results_of(patterned_counts(5), chinello(), true);
  std::map<std::string, std::size_t> rows;
  for (const Block& block : blocks_of(results)) {
    rows[block.id] = block.rows();
    CHECK(block.csv_rows().find("nan") == std::string::npos);
  }
  // Of counts alone nobody knows when they were answered, so that nothing stands with a drift.
  CHECK(rows == std::map<std::string, std::size_t>{{"hierarchical", 3},
                                                   {"hierarchical_ratios", 3},
                                                   {"hierarchical_check", 12},
                                                   {"hierarchical_people", 15},
                                                   {"hierarchical_variants", 4},
                                                   {"hierarchical_variant_jnds", 6}});

  const StudyResults many = results_of(patterned_counts(201), chinello(), true);
  const std::vector<Block> refused = blocks_of(many);
  REQUIRE(refused.size() == 1);
  CHECK(refused.front().id == "hierarchical");
  CHECK(refused.front().text(0, "status") == "too_many_people");
  CHECK(refused.front().number(0, "participants") == 201);
  CHECK(refused.front().text(0, "jnd").empty());
}

}  // namespace
}  // namespace jnd
