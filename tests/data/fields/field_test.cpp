// Fields and blocks of them: a cell is what its field holds.
#include "data/fields/field.h"

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "analysis/numerics/special_values.h"
#include "data/fields/block.h"
#include "tests/catch.h"

namespace jnd {
namespace {

struct Row {
  int n = 3;
  double x = 0.1;
  bool flag = true;
  std::string text = "=SUM(A1)";
  std::optional<int> none;
};

TEST_CASE("a column holds what its field says", "[data]") {
  const Fields<Row> fields = {{"n", "a count", &Row::n},
                              {"of.x", "a number", &Row::x, {.unit = "N"}},
                              {"flag", "a flag", &Row::flag, {.levels = "0 1"}},
                              {"text", "a text", &Row::text},
                              {"none", "nothing", &Row::none},
                              {"list", "numbers",
                               [](const Row& row) {
                                 return std::vector<double>{row.x, 2};
                               }},
                              {"hidden", "", &Row::n, {.place = Place::table}}};
  CHECK(fields[0].number);
  CHECK(fields[4].number);
  CHECK_FALSE(fields[2].number);
  CHECK_FALSE(fields[3].number);
  const std::string table = "n,of_x,flag,text,none,list\n3,0.1,1,'=SUM(A1),,0.1 2\n";
  CHECK(csv_table(csv_columns(fields), std::vector<Row>(1)) == table);
  Block block;
  block.id = "f";
  block.with(fields, std::vector<Row>(1));
  CHECK(block.csv_header() + block.csv_rows() == table);
  CHECK(block.csv_header("study,") + block.csv_rows("7,") ==
        "study,n,of_x,flag,text,none,list\n7,3,0.1,1,'=SUM(A1),,0.1 2\n");
  std::vector<DictionaryRow> dictionary;
  block.describe(dictionary);
  REQUIRE(dictionary.size() == 6);
  CHECK(dictionary[1].file == "f.csv");
  CHECK(dictionary[1].column == "of_x");
  CHECK(dictionary[1].meaning == "a number");
  CHECK(dictionary[1].unit == "N");
  CHECK(dictionary[2].levels == "0 1");

  CHECK(block.number(0, "of.x") == 0.1);
  CHECK(block.number(0, "n") == 3);
  CHECK(std::isnan(block.number(0, "text")));
  CHECK(block.text(0, "text") == "=SUM(A1)");
  CHECK(block.text(0, "flag") == "1");
  CHECK(block.text(0, "none").empty());
  CHECK(block.flag(0, "flag"));
  CHECK(block.numbers(0, "list") == std::vector<double>{0.1, 2});
  CHECK(block.number(0, "hidden") == 3);
  CHECK_FALSE(block.has("unknown"));
  CHECK_THROWS_AS(block.field("unknown"), std::logic_error);
  CHECK(block_named({block}, "g") == nullptr);
  CHECK(csv_value(kNaN).empty());
  CHECK(csv_value(kInf) == "Inf");
}

}  // namespace
}  // namespace jnd
