// Blocks of results as tables, text and JSON.
#include "runner/results/block_output.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "analysis/numerics/special_values.h"
#include "data/blocks/result_blocks.h"
#include "data/results/hierarchical_words.h"
#include "runner/results/analysis_text.h"
#include "tests/catch.h"
#include "tests/runner/report_fixture.h"

namespace jnd {
namespace {

// Blocks of results as tables, text and JSON.

using Cells = std::vector<std::string>;

struct Row {
  std::string name = "P01", status = "ok";
  double jnd = 283.456, low = 250.12, high = 316.78, p = 0.0312, share = 0.355;
  std::optional<int> trials = 36;
  std::vector<double> levels{};
  bool shown = false;
};

constexpr double kLimit = 4800;

Block block_of(std::vector<Row> rows) {
  Block block;
  block.id = "estimates";
  block.title = "Participants";
  block.columns = {{"name"},   {"jnd"},    range("ci.low", "ci.high"), {"p"}, {"share", {}, {}, "part"}, {"slope"},
                   {"trials"}, {"remarks"}};
  block.answer = {"In short", "a note", {{"name"}, share("trials", "total", "done")}, "shown"};
  const FieldTraits jnd{.title = "JND", .limit = kLimit, .limit_text = "12 x 400 N/m"};
  const Fields<Row> fields = {
      {"name", "who", &Row::name},
      {"jnd", "JND", &Row::jnd, jnd},
      {"ci.low", "lower end", &Row::low, jnd},
      {"ci.high", "upper end", &Row::high, jnd},
      {"p", "of the test", &Row::p, {.shown = Shown::p_value}},
      {"share", "of all", &Row::share, {.shown = Shown::percent}},
      {"slope", "steep", [](const Row& row) { return 1 / row.jnd; }, {.factor = 100}},
      {"trials", "counted", &Row::trials},
      {"total", "planned", [](const Row&) { return 40; }},
      {"levels", "presented", &Row::levels},
      {"shown", "whether it is part of the answer", &Row::shown},
      {"status", "ok, or why there is no JND", &Row::status},
      {"remarks", "", [](const Row& row) { return row.status == "ok" ? "" : row.status; }, {.place = Place::table}}};
  return std::move(block.with(fields, std::move(rows)));
}

Cells cells_of(const Row& row) {
  Row full;  // a column that is empty in every row is left out
  full.name = "P00";
  full.status = "remark";
  return table_of(block_of({full, row})).rows.at(1);
}

TEST_CASE("a table shows numbers with the digits that their interval or size deserves") {
  Row other;
  other.shown = true;
  const Block block = block_of({Row(), other});
  const ResultTable table = table_of(block);
  std::string names, right;
  for (const ResultTable::Column& column : table.columns) {
    names += column.name + "|";
    right += column.number ? "r" : "l";
  }
  CHECK(names == "name|JND|95 % CI|p|part|slope|trials|");  // nobody has a remark
  CHECK(right == "lrrrrrr");
  CHECK(table.rows.at(0) == Cells{"P01", "283", "250 to 317", ".031", "35.5 %", "0.353", "36"});
  CHECK(table.rows.at(1).front().empty());  // named in the row above
  const ResultTable answer = answer_of(block);
  CHECK(answer.title == "In short");
  CHECK(answer.rows == std::vector<Cells>{{"P01", "36 of 40"}});
  CHECK(text_of(answer) == "In short\na note\n  name       done\n  P01    36 of 40\n\n");
  CHECK(json_row(block, 0).dump() ==
        R"({"name":"P01","jnd":283.456,"ci":{"low":250.12,"high":316.78},"p":0.0312,"share":0.355,)"
        R"("slope":0.0035278843982840366,"trials":36,"total":40,"levels":[],"shown":false,"status":"ok"})");
}

TEST_CASE("what is missing, beyond the levels or very small is never shown as a number that it is not") {
  Row missing;
  missing.status = "no_sensitivity";
  missing.jnd = missing.high = missing.p = missing.share = kNaN;
  missing.low = 5000;
  missing.trials.reset();
  CHECK(cells_of(missing) == Cells{"P01", "-", "-", "-", "-", "-", "", "no_sensitivity"});
  missing.high = kInf;  // it lies above the levels
  CHECK(cells_of(missing)[2] == "> 12 x 400 N/m to > 12 x 400 N/m");
  missing.low = 900;
  CHECK(cells_of(missing)[2] == "900 to > 12 x 400 N/m");
  missing.levels = {400, kInf, -kInf, kNaN};
  CHECK(json_row(block_of({missing}), 0).dump() ==
        R"({"name":"P01","jnd":null,"ci":{"low":900.0,"high":"inf"},"p":null,"share":null,"slope":null,"trials":null,)"
        R"("total":40,"levels":[400.0,"inf","-inf",null],"shown":false,"status":"no_sensitivity"})");
  missing.levels.pop_back();
  CHECK(block_of({missing}).csv_row(0) == "P01,,900,Inf,,,,,40,400 Inf -Inf,0,no_sensitivity\n");

  Row ceiling;  // it lies below them
  ceiling.status = "ceiling";
  ceiling.jnd = kNaN;
  ceiling.low = 0;
  ceiling.high = 45.3;
  CHECK(cells_of(ceiling)[2] == "0 to 45");

  Row small;
  small.jnd = 3.2e-9;
  small.low = small.high = kNaN;
  small.p = 3.2e-7;
  small.share = 4e-6;
  const Cells cells = cells_of(small);
  CHECK(cells[1] == "3e-09");
  CHECK(cells[3] == "< .001");
  CHECK(cells[4] == "0.0004 %");
  small.p = 1;
  CHECK(cells_of(small)[3] == "1.000");
}

TEST_CASE("a block without rows, or without a table, is no table") {
  Block block = block_of({});
  CHECK(table_of(block).rows.empty());
  CHECK(answer_of(block).rows.empty());
  CHECK(json_rows(block).dump() == "[]");
  CHECK(block.csv_rows().empty());
  block = block_of({Row()});
  block.columns.clear();
  block.answer = {};
  CHECK(table_of(block).rows.empty());
  CHECK(answer_of(block).rows.empty());
  CHECK(json_rows(block).size() == 1);
  CHECK_THROWS_AS(block.field("unknown"), std::logic_error);
}

TEST_CASE("results have one JSON of all blocks, and their text begins with the answer") {
  const Protocol protocol = published_protocol();
  StudyResults results = invented_study(protocol, 4);
  CHECK(cautions_text(results).empty());
  results.deviations = {"one less"};
  results.cautions = {"too few"};
  CHECK(cautions_text(results) == "deviation: one less\ncaution: too few\n\n");
  CHECK(who_took_part(results, protocol) == "4 simulated participants (18 planned)");
  results.hierarchical.emplace();
  results.hierarchical->reason = "too many";
  results.hierarchical->cautions = {"few people"};
  const std::vector<Block> blocks = result_blocks(results, protocol);
  const nlohmann::ordered_json json = to_json(results, blocks, protocol);
  for (const Block& block : blocks) {
    INFO(block.id);
    CHECK(json.at(block.id).size() == block.rows());
  }
  CHECK(json.at("outcome") == "slope");
  CHECK(json.at("cautions") == nlohmann::json{"too few"});
  CHECK(json.at("hierarchical_reason") == "too many");
  CHECK(json.at("hierarchical_cautions") == nlohmann::json{"few people"});
  const std::string text = answer_text(results, blocks, protocol);
  CHECK(text.find("JND N/m by condition") < text.find("Registered contrasts"));
  CHECK(text.find("nan") == std::string::npos);
}

// The hierarchical model as tables and JSON: what is ok is not said, what is missing has its reason.

StudyResults with_model(const Protocol& protocol, int participants) {
  StudyResults results = invented_study(protocol, participants);
  results.hierarchical = study_hierarchical(results.task, protocol);
  return results;
}

Block block_of(const StudyResults& results, const Protocol& protocol, const std::string& id) {
  const Blocks blocks = hierarchical_blocks(results, protocol);
  const Block* const found = block_named(blocks, id);
  if (found == nullptr) throw std::runtime_error("no block " + id);
  return *found;
}

ResultTable table_named(const StudyResults& results, const Protocol& protocol, const std::string& id) {
  return table_of(block_of(results, protocol, id));
}

nlohmann::ordered_json json_named(const StudyResults& results, const Protocol& protocol, const std::string& id) {
  return json_rows(block_of(results, protocol, id));
}

bool says(const ResultTable& table, std::string_view words) {
  return std::any_of(table.footnotes.begin(), table.footnotes.end(),
                     [words](const std::string& note) { return note.find(words) != std::string::npos; });
}

TEST_CASE("the hierarchical model has its blocks where it was added") {
  const Protocol protocol = published_protocol();
  StudyResults results = invented_study(protocol, 9);
  CHECK(hierarchical_blocks(results, protocol).empty());
  results = with_model(protocol, 9);
  for (const Block& block : hierarchical_blocks(results, protocol))
    CHECK(block.section == (block.id == "hierarchical_people" ? Section::participants : Section::tests));
  const ResultTable group = table_named(results, protocol, "hierarchical");
  CHECK(group.rows.size() == 3);
  CHECK(says(group, "one JND for all conditions"));
  CHECK(says(group, "standard deviation between people"));
  CHECK(group.footnotes.back() == hierarchical_assumptions(*results.hierarchical));
  const ResultTable ratios = table_named(results, protocol, "hierarchical_ratios");
  CHECK(ratios.rows.size() == 3);
  CHECK(ratios.rows.front().front() == "S : V");
  const ResultTable check = table_named(results, protocol, "hierarchical_check");
  REQUIRE(check.rows.size() == 3 * 4);
  CHECK(check.rows.front().front() == "S");
  CHECK(says(check, "The model d"));
  CHECK(check.footnotes.back() == kPredictiveMeaning);
  const nlohmann::ordered_json checked = json_named(results, protocol, "hierarchical_check");
  CHECK(checked.at(1).at("draws") == kPredictiveDraws);
  CHECK(checked.at(1).at("drawn_status") == "inside");
  CHECK(checked.at(1).at("discrepancy_p") > 0);
  const ResultTable left_out = table_named(results, protocol, "hierarchical_variants");
  REQUIRE(left_out.rows.size() == 4);  // drift has two parameters
  CHECK(left_out.rows[1].front() == "ln JND, second half less first");
  CHECK(left_out.rows[1].back() == "not_identified");  // of counts alone
  CHECK(json_named(results, protocol, "hierarchical_variants").at(1).at("status") == "not_identified");
  const ResultTable with_that = table_named(results, protocol, "hierarchical_variant_jnds");
  REQUIRE(with_that.rows.size() == 2 * 3);
  CHECK(with_that.rows[3].front() == "lapse");
  CHECK(json_named(results, protocol, "hierarchical_variant_jnds").at(0).at("width_ratio") >= 0.999);
  const ResultTable people = table_named(results, protocol, "hierarchical_people");
  CHECK(people.rows.size() == 27);
  CHECK(people.rows[1].front().empty());  // named once
  CHECK(people.columns.back().name == "criterion");

  StudyHierarchical& model = *results.hierarchical;
  model.check->rows[2].share.status = BandStatus::below;
  model.check->rows[2].between.status = BandStatus::above;
  const ResultTable outside = table_named(results, protocol, "hierarchical_check");
  CHECK(outside.columns.back().name == "outside");
  CHECK(outside.rows[2].back() == "share below, sd above");
  model.check.reset();
  CHECK_THROWS(block_of(results, protocol, "hierarchical_check"));
  model.people[3].status = ShrunkenStatus::missing;
  model.people[4].separate_status = JndStatus::no_sensitivity;
  const ResultTable odd = table_named(results, protocol, "hierarchical_people");
  CHECK(odd.columns.back().name == "status");
  CHECK(odd.rows[3].back() == "missing");
  CHECK(odd.rows[0].back().empty());
  CHECK(odd.rows[4][3] == "no_sensitivity");
}

TEST_CASE("what limits the numbers of the hierarchical model is said beside them") {
  const Protocol protocol = published_protocol();
  StudyResults results = with_model(protocol, 4);
  StudyHierarchical& model = *results.hierarchical;
  const auto table = [&](const std::string& id) { return table_named(results, protocol, id); };
  REQUIRE(says(table("hierarchical"), "4 participants are few: "));
  results.cautions = model.cautions;
  CHECK_FALSE(says(table("hierarchical"), "are few"));  // it is said of the study
  results.cautions.clear();

  model.conditions[0].ci_low = model.conditions[0].ci_high = kNaN;
  model.conditions[0].ci_status = EndsStatus::out_of_work;
  model.conditions[1].status = SlopeStatus::one_answer;
  model.ratios[0].ci_low = model.ratios[0].ci_high = kNaN;
  model.ratios[0].ci_status = EndsStatus::not_converged;
  model.persons = {SpreadStatus::at_limit, 2};
  CHECK_FALSE(model.alike());
  CHECK_FALSE(are_alike(SpreadStatus::zero, SpreadStatus::by_condition));
  CHECK(are_alike(SpreadStatus::zero, SpreadStatus::not_asked));
  HierarchicalFit fit;
  fit.conditions.resize(2);
  fit.conditions[1].tv_status = SpreadStatus::at_limit;
  const std::vector<std::string> said = hierarchical_cautions(fit, {"PV", "S"}, {});
  CHECK(std::any_of(said.begin(), said.end(),
                    [](const std::string& one) { return one.starts_with("at_limit (between persons in S (tv))"); }));
  const ResultTable group = table("hierarchical");
  CHECK(group.rows[0].back() == "interval out_of_work");
  CHECK(group.rows[1].back() == "one_answer");
  CHECK(group.rows[2].back() == "ok");
  CHECK(says(group, "at_limit 2.00 of ln JND"));
  CHECK(table("hierarchical_ratios").rows[0].back() == "interval not_converged");
  const nlohmann::ordered_json json = json_named(results, protocol, "hierarchical");
  CHECK(json.at(0).at("ci_status") == "out_of_work");
  CHECK(json.at(0).at("ci_low").is_null());

  model.status = HierarchicalStatus::not_converged;
  const ResultTable unsettled = table("hierarchical");
  CHECK(unsettled.rows[0].back() == "not_converged, interval out_of_work");
  CHECK(unsettled.rows[1].back() == "one_answer");
  CHECK_FALSE(table("hierarchical_people").rows.empty());
}

TEST_CASE("where there is no hierarchical model, its table and JSON say why") {
  const Protocol protocol = published_protocol();
  const StudyResults results = results_of(
      results_of_counts(invented_counts(protocol, 201, 5), protocol, SessionKind::simulated), 201, protocol, true);
  const ResultTable group = table_named(results, protocol, "hierarchical");
  CHECK(group.rows.front().back() == "too_many_people");
  CHECK(says(group, "no model: it is left out above 200 participants"));
  CHECK_THROWS(block_of(results, protocol, "hierarchical_people"));
  for (const char* const id : {"hierarchical_ratios", "hierarchical_variants", "hierarchical_variant_jnds"})
    CHECK(table_named(results, protocol, id).rows.empty());
  const nlohmann::ordered_json json = json_named(results, protocol, "hierarchical").at(0);
  CHECK(json.at("status") == "too_many_people");
  CHECK(json.at("observer") == "yes_no");
  for (const char* const key : {"jnd", "sd_persons", "sd_persons_status", "equal_p"}) CHECK(json.at(key).is_null());
}

}  // namespace
}  // namespace jnd
