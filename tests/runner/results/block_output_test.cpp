// Blocks of results as tables, text and JSON.
#include "runner/results/block_output.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "analysis/numerics/special_values.h"
#include "data/blocks/result_blocks.h"
#include "runner/results/analysis_text.h"
#include "tests/catch.h"
#include "tests/runner/report_fixture.h"

namespace jnd {
namespace {

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

}  // namespace
}  // namespace jnd
