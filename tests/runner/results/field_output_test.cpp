// Fields of results as JSON and as tables for people.
#include "runner/results/field_output.h"

#include <optional>
#include <string>
#include <vector>

#include "analysis/numerics/special_values.h"
#include "tests/catch.h"

namespace jnd {
namespace {

struct Row {
  std::string name = "P01";
  double low = 0.12345, high = 2, p = 3.2e-7, share = 0.355;
  std::optional<int> none;
};

Fields<Row> fields() {
  return {{"name", "who", &Row::name},
          {"ci.low", "lower end", &Row::low, {.digits = 2}},
          {"ci.high", "upper end", &Row::high, {.digits = 2}},
          {"p", "of the test", &Row::p, {.title = "p(exact)", .shown = Shown::p_value}},
          {"share", "of all", &Row::share, {.shown = Shown::percent}},
          beside<Row>("none", &Row::none),
          {"slope", "steep", &Row::low, {.digits = 1, .factor = 100}}};
}

TEST_CASE("JSON has the fields that are named, in that order") {
  CHECK(json_of(fields(), Row(), {"p", "ci.*", "none"}).dump() ==
        R"({"p":3.2e-07,"ci":{"low":0.12345,"high":2.0},"none":null})");
  CHECK(json_of(fields(), Row(), {"*"}).size() == 6);
  CHECK_THROWS_AS(json_of(fields(), Row(), {"unknown"}), std::logic_error);
}

TEST_CASE("a table shows each number with the digits of its field") {
  const TableMaker of(fields());
  Row undefined;
  undefined.low = kNaN;
  const ResultTable table =
      of({"id", "Title", "", {}, {}, {}},
         {of("name"), of.range("ci.low", "ci.high"), of("p"), of("share", "part"), of("none"), of("slope"),
          of.share("ci.low", "ci.high", "both", "/"), of.words("own", [](const Row& row) { return row.name + "!"; })},
         {Row(), undefined});
  std::vector<std::string> names;
  std::string right;
  for (const ResultTable::Column& column : table.columns) {
    names.push_back(column.name);
    right += column.number ? "r" : "l";
  }
  CHECK(names == std::vector<std::string>{"name", "95 % CI", "p(exact)", "part", "none", "slope", "both", "own"});
  CHECK(right == "lrrrrrrl");
  REQUIRE(table.rows.size() == 2);
  CHECK(table.rows[0] ==
        std::vector<std::string>{"P01", "0.12 to 2.00", "3.2e-07", "35.5 %", "", "12.3", "0.12/2.00", "P01!"});
  CHECK(table.rows[1][1] == "-");
  CHECK(table.rows[1][5] == "-");
}

}  // namespace
}  // namespace jnd
