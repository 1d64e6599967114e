// Fields, blocks of them and the numbers in them.
#include "data/fields/field.h"

#include <cmath>
#include <cstdlib>
#include <optional>
#include <string>
#include <vector>

#include <rapidcheck.h>

#include "analysis/numerics/special_values.h"
#include "data/fields/block.h"
#include "data/fields/number_text.h"
#include "tests/catch.h"

namespace jnd {
namespace {

// Fields and blocks of them: a cell is what its field holds.

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

// Numbers as people read them: as many digits as mean something, and never 0 for what is not.

TEST_CASE("a number has the digits that its spread or size lets mean something", "[data]") {
  CHECK(decimals_of_spread(12.3) == 0);
  CHECK(decimals_of_spread(1.23) == 1);
  CHECK(decimals_of_spread(0.123) == 2);
  CHECK(decimals_of_spread(1e-12) == 6);
  CHECK(decimals_of_spread(kNaN) == decimals_of_spread(0));
  CHECK(decimals_of_size(123) == 0);
  CHECK(decimals_of_size(0.0123) == 4);
  CHECK(number_text(12.345, 1) == "12.3");
  CHECK(number_text(0.0004, 2) == "0.0004");
  CHECK(number_text(-0.0004, 2) == "-0.0004");
  CHECK(number_text(0, 2) == "0.00");
  CHECK(number_text(-0.0, 2) == "0.00");
  CHECK(number_text(kNaN, 2) == "-");
  CHECK(number_text(-kInf, 2) == "-inf");
  CHECK(percent_text(0.3553) == "35.5 %");
  CHECK(range_text(1.25, kInf, 1) == "1.2 to inf");
  CHECK(range_text(kNaN, 2, 1) == "-");
  CHECK(counted(1, "session") == "1 session");
  CHECK(counted(0, "session") == "0 sessions");
  REQUIRE(rc::check("what is not 0 is not printed as 0", [] {
    const double value = *rc::gen::inRange(1, 10000) * std::pow(10, *rc::gen::inRange(-12, 3));
    RC_ASSERT(std::strtod(number_text(value, *rc::gen::inRange(0, 7)).c_str(), nullptr) != 0);
  }));
}

TEST_CASE("a p has three decimals, and is neither 0 nor 1 where it is not", "[data]") {
  CHECK(p_value_text(0.0312) == ".031");
  CHECK(p_value_text(0.001) == ".001");
  CHECK(p_value_text(0.00099) == "< .001");
  CHECK(p_value_text(0) == "< .001");
  CHECK(p_value_text(0.9996) == "> .999");
  CHECK(p_value_text(1) == "1.000");
  CHECK(p_value_text(kNaN) == "-");
  CHECK(p_text(0.0312) == "p = .031");
  CHECK(p_text(1e-9) == "p < .001");
  CHECK(p_text(kNaN) == "no p");
}

}  // namespace
}  // namespace jnd
