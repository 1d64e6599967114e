// Fields of results: every name is said once, and a CSV cell is what the field holds.
#include "data/fields/field.h"

#include <limits>
#include <set>
#include <string>

#include "analysis/numerics/special_values.h"
#include "data/fields/answer_fields.h"
#include "data/fields/hierarchical_fields.h"
#include "data/fields/result_fields.h"
#include "tests/catch.h"
#include "tests/data/study_fixture.h"

namespace jnd {
namespace {

Protocol shipped(const std::string& name) {
  return load_protocol(std::string(JND_SOURCE_DIR) + "/protocols/" + name + ".json");
}

template <typename Row>
void check_names(const Fields<Row>& fields) {
  std::set<std::string> keys, columns;
  for (const Field<Row>& field : fields) {
    INFO(field.key);
    CHECK(keys.insert(field.key).second);
    if (field.column.empty()) continue;
    CHECK(columns.insert(field.column).second);
    CHECK_FALSE(field.meaning.empty());
  }
}

TEST_CASE("no two fields of a block have one name", "[data]") {
  for (const char* name : {"tutorial", "chinello2017", "cutaneous-kinaesthetic"}) {
    const Protocol protocol = shipped(name);
    check_names(cell_fields(protocol));
    check_names(threshold_fields(protocol));
    check_names(group_fields(protocol, SessionKind::real));
    check_names(contrast_fields(protocol, SessionKind::real));
    check_names(pair_fields(protocol));
    check_names(hierarchical_fields(protocol, SessionKind::real));
    check_names(hierarchical_ratio_fields(protocol, SessionKind::real));
    check_names(hierarchical_check_fields(protocol, SessionKind::real));
    check_names(hierarchical_person_fields(protocol, SessionKind::real));
    check_names(sensitivity_fields(protocol));
    check_names(model_fields(protocol));
    check_names(behaviour_fields(protocol));
    check_names(cue_fields(protocol));
    check_names(score_fields(protocol));
    check_names(rating_fields(protocol));
  }
  check_names(test_fields());
  check_names(effect_fields());
  for (const char* name : {"adaptive-quest", "adaptive-staircase", "adaptive-posterior", "adaptive-staircase-90"}) {
    const Protocol protocol = shipped(name);
    check_names(track_fields(protocol));
    check_names(adaptive_group_fields(protocol));
    check_names(contrast_fields(protocol, SessionKind::pilot));
  }
  const Protocol explore = shipped("chinello2017-experiment2");
  check_names(option_fields(explore));
  check_names(exposure_fields(explore));
}

struct Row {
  int n = 3;
  double x = 0.1;
  bool flag = true;
  std::string text = "=SUM(A1)";
  std::optional<int> none;
};

TEST_CASE("a column holds what its field says", "[data]") {
  const Fields<Row> fields = {{"n", "a count", &Row::n},
                              {"x", "a number", &Row::x, {.column = "x_n", .unit = "N"}},
                              {"flag", "a flag", &Row::flag, {.levels = "0 1"}},
                              {"text", "a text", &Row::text},
                              {"none", "nothing", &Row::none},
                              beside<Row>("hidden", &Row::n)};
  CHECK(fields[0].number);
  CHECK(fields[4].number);
  CHECK_FALSE(fields[2].number);
  CHECK_FALSE(fields[3].number);
  const auto columns = csv_columns(fields);
  CHECK(csv_table(columns, std::vector<Row>(1)) == "n,x_n,flag,text,none\n3,0.1,1,'=SUM(A1),\n");
  std::vector<DictionaryRow> dictionary;
  describe("f.csv", columns, dictionary);
  REQUIRE(dictionary.size() == 5);
  CHECK(dictionary[1].column == "x_n");
  CHECK(dictionary[1].meaning == "a number");
  CHECK(dictionary[1].unit == "N");
  CHECK(dictionary[2].levels == "0 1");
  CHECK(csv_value(kNaN).empty());
  CHECK(csv_value(std::numeric_limits<double>::infinity()) == "Inf");
  CHECK_THROWS_AS(field_of(fields, "unknown"), std::logic_error);
}

}  // namespace
}  // namespace jnd
