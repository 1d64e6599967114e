#include "protocols/reading/protocol_difference.h"

#include <fmt/format.h>

#include "protocols/input/input_error.h"
#include "tests/catch.h"
#include "tests/protocols/examples.h"

using namespace jnd;
using namespace jnd::test;

TEST_CASE("other bytes of the same meaning: blanks, order of members, spelling of numbers, the schema's place") {
  const std::string one = R"({"a": 1, "b": [0.5, true, null], "c": "x"})";
  CHECK(difference_of(one, one).same_meaning);
  const ProtocolDifference same =
      difference_of(one, "{\"$schema\": \"s.json\",\n  \"c\": \"\\u0078\",\n  \"b\": [5e-1, true, null], \"a\": 1.0}");
  CHECK(same.same_meaning);
  CHECK(same.lines.empty());
}

TEST_CASE("each difference has its path, the old value and the new one") {
  const ProtocolDifference found =
      difference_of(R"({"a": {"n": 18, "t": "old"}, "list": [1, 2, 3], "gone": {"x": [1]}, "kind": 1, "on": true})",
                    R"({"a": {"n": 24, "t": "new"}, "list": [1, 5], "kind": "1", "on": false, "new key": null})");
  CHECK_FALSE(found.same_meaning);
  CHECK(found.lines == std::vector<std::string>{"$.a.n: 18 -> 24", "$.a.t: \"old\" -> \"new\"", "$.list[1]: 2 -> 5",
                                                "$.list[2]: removed 3", "$.gone: removed {\"x\": [1]}",
                                                "$.kind: 1 -> \"1\"", "$.on: true -> false",
                                                "$[\"new key\"]: added null"});
}

TEST_CASE("named things are compared by their names: one that is inserted in front is one difference") {
  const std::string s = R"({"name": "S", "cues": ["skin"]})", v = R"({"name": "V", "cues": []})";
  const auto lines = [](const std::string& before, const std::string& after) {
    return difference_of(R"({"l": [)" + before + "]}", R"({"l": [)" + after + "]}").lines;
  };
  using Lines = std::vector<std::string>;
  CHECK(lines(s + ", " + v, R"({"name": "N"}, )" + s + ", " + v) == Lines{R"($.l[0]: added {"name": "N"})"});
  CHECK(lines(s + ", " + v, v) == Lines{R"($.l[0]: removed {"name": "S", "cues": ["skin"]})"});
  CHECK(lines(s + ", " + v, R"({"name": "N"}, {"name": "S", "cues": []}, )" + v) ==
        Lines{R"($.l[0].cues[0]: removed "skin")", R"($.l[0]: added {"name": "N"})"});
  // The order is part of the meaning.
  CHECK(lines(s + ", " + v, v + ", " + s) == Lines{R"($.l: the order "S", "V" -> "V", "S")"});
  const ProtocolDifference order = difference_of("[" + s + ", " + v + "]", "[" + v + ", " + s + "]");
  REQUIRE(order.changes.size() == 1);
  CHECK_FALSE(order.same_meaning);
  CHECK(order.changes.front().path == "$");
  CHECK(order.changes.front().after == "[" + v + ", " + s + "]");
  // "id" before "name"; names that stand twice are none.
  CHECK(lines(R"({"id": "a", "name": "x"})", R"({"id": "b", "name": "x"}, {"id": "a", "name": "y"})") ==
        Lines{R"($.l[0].name: "x" -> "y")", R"($.l[0]: added {"id": "b", "name": "x"})"});
  CHECK(lines(s + ", " + s, v + ", " + s + ", " + s) == Lines{R"($.l[0]: added {"name": "V", "cues": []})"});
}

TEST_CASE("lists without names are compared by what they have in common") {
  using Lines = std::vector<std::string>;
  const auto lines = [](const std::string& before, const std::string& after) {
    return difference_of(before, after).lines;
  };
  CHECK(lines("[1, 2, 3, 4]", "[0, 1, 2, 3, 4]") == Lines{"$[0]: added 0"});
  CHECK(lines("[1, 2, 3, 4]", "[1, 2, 2.5, 3, 4]") == Lines{"$[2]: added 2.5"});
  CHECK(lines("[1, 2, 3, 4]", "[1, 3, 4]") == Lines{"$[1]: removed 2"});
  CHECK(lines("[1, 2, 3, 4]", "[2, 3, 9, 4, 5]") == Lines{"$[0]: removed 1", "$[2]: added 9", "$[4]: added 5"});
  CHECK(lines(R"([{"after": 1}, {"after": 2}])", R"([{"after": 3}, {"after": 1}, {"after": 2}])") ==
        Lines{R"($[0]: added {"after": 3})"});
  CHECK(lines(R"([{"after": 1}, {"after": 2, "s": 1}])", R"([{"after": 1}, {"s": 5, "after": 2}])") ==
        Lines{"$[1].s: 1 -> 5"});
  CHECK(lines("[]", "[[1], [1]]") == Lines{"$[0]: added [1]", "$[1]: added [1]"});
  CHECK(lines("[1, 2]", "[2, 1]").size() == 2);
  // Too long for the table of common subsequences: by place.
  std::string one = "[0", other = "[1";
  for (int i = 2; i < 3000; ++i) {
    one += fmt::format(", {}", i);
    other += fmt::format(", {}", -i);
  }
  CHECK(difference_of(one + "]", other + "]").changes.size() == 2999);
}

TEST_CASE("lines are bounded in number and length, and hold no control characters") {
  std::string before = "{", after = "{";
  for (int i = 0; i < 50; ++i) {
    before += (i == 0 ? "" : ", ") + ("\"k" + std::to_string(i)) + "\": 1";
    after += (i == 0 ? "" : ", ") + ("\"k" + std::to_string(i)) + "\": 2";
  }
  const ProtocolDifference many = difference_of(before + "}", after + "}", 5);
  REQUIRE(many.lines.size() == 6);
  CHECK(many.lines[4] == "$.k4: 1 -> 2");
  CHECK(many.lines[5] == "and 45 more");
  CHECK(difference_of(before + "}", after + "}", 50).lines.size() == 50);

  const std::string start(300, 'a');
  const ProtocolDifference longer = difference_of(
      "{\"t\": \"" + start + "b\"}", "{\"t\": \"" + start + "c\", \"l\": [" + start.substr(0, 0) +
                                         "1111111111, 2222222222, 3333333333, 4444444444, 5555555555, 6]}");
  REQUIRE(longer.lines.size() == 2);
  CHECK(longer.lines[0].size() < 120);
  CHECK(longer.lines[0].find("ab\" -> ") != std::string::npos);  // from where they part
  CHECK(longer.lines[1].size() < 90);
  CHECK(longer.lines[1].find("...") != std::string::npos);

  const ProtocolDifference hostile = difference_of(R"({"\u001b[2J": "\u001b]0;x\u0007"})", R"({"a": "\u009b1m"})");
  for (const std::string& line : hostile.lines)
    for (const char c : line) CHECK(static_cast<unsigned char>(c) >= 0x20);
  CHECK_THROWS_AS(difference_of("{", "{}"), InputError);
  CHECK_THROWS_AS(difference_of("{}", "nonsense"), InputError);
}

TEST_CASE("every change has the whole values as JSON, also beyond the lines that are shown") {
  const std::string words(100, 'w');
  const ProtocolDifference found = difference_of(R"({"a": 1.50, "b": {"c": [true, null]}, "t": "x"})",
                                                 R"({"a": 2, "t": ")" + words + R"(\"\n", "d": {"e": [1e3, "f"]}})", 1);
  REQUIRE(found.changes.size() == 4);
  CHECK(found.lines.size() == 2);
  const auto is = [&found](std::size_t i, const std::string& path, const std::string& before,
                           const std::string& after) {
    CHECK(found.changes[i].path == path);
    CHECK(found.changes[i].before == before);
    CHECK(found.changes[i].after == after);
  };
  is(0, "$.a", "1.50", "2");
  is(1, "$.b", R"({"c": [true, null]})", "");
  is(2, "$.t", R"("x")", '"' + words + R"(\"\n")");
  is(3, "$.d", "", R"({"e": [1e3, "f"]})");
}

TEST_CASE("a shipped protocol and a changed copy") {
  const std::string bytes = read_text(protocols_folder() / "tutorial.json");
  const ProtocolDifference found =
      difference_of(bytes, replaced(bytes, "\"trials_per_cell\": 8", "\"trials_per_cell\": 12"));
  CHECK(found.lines == std::vector<std::string>{"$.design.trials_per_cell: 8 -> 12"});
}
