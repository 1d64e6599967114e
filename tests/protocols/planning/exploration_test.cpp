// Free interaction: the shipped experiment, its plan and its balance.
#include <map>
#include <set>
#include <stdexcept>

#include "protocols/course/duration.h"
#include "protocols/input/input_error.h"
#include "protocols/planning/cohort.h"
#include "protocols/planning/order.h"
#include "protocols/planning/plan.h"
#include "protocols/reading/protocol_json.h"
#include "protocols/rigs/device_lint.h"
#include "tests/catch.h"
#include "tests/protocols/examples.h"

using namespace jnd;
using namespace jnd::test;

namespace {

Protocol experiment2() {
  return load_protocol(protocols_folder() / "chinello2017-experiment2.json");
}

}  // namespace

TEST_CASE("experiment 2 is the published one") {
  const Protocol protocol = experiment2();
  CHECK(protocol.task.kind == TaskKind::explore);
  CHECK(protocol.design.participants == 12);
  REQUIRE(protocol.explore);
  CHECK(protocol.explore->duration_s == 300);
  CHECK(protocol.explore->objects == std::vector<std::string>{"baseball", "teddy-bear"});
  REQUIRE(protocol.conditions.size() == 2);
  CHECK(protocol.conditions[0].devices);
  CHECK_FALSE(protocol.conditions[1].devices);
  CHECK(protocol.conditions[1].cues == Cues{});
  CHECK(protocol.series.empty());

  std::map<std::string, int> items;
  for (const Question& question : protocol.questions) {
    if (question.group.empty()) continue;
    ++items[question.group];
    CHECK(question.kind == Question::Kind::rating);
    CHECK(question.min == 1);
    CHECK(question.max == 9);
    CHECK(question.low_label == "completely disagree");
    CHECK(question.high_label == "completely agree");
    CHECK(question.when == (question.group == "QA" ? Question::When::after_session : Question::When::after_condition));
  }
  CHECK(items == std::map<std::string, int>{{"QA", 4}, {"QB", 9}, {"QC", 3}, {"QD", 5}});

  // Table 2: QA of C only, the 17 others of both conditions.
  CHECK(protocol.published.size() == 4 + 2 * 17);
  double sum = 0;
  for (const PublishedValue& value : protocol.published) {
    CHECK(value.quantity == "rating");
    CHECK_FALSE(value.question.empty());
    REQUIRE(value.sd);
    sum += value.value;
    if (value.question == "QD2") CHECK(value.value == (value.condition == "C" ? 8.7 : 6.2));
  }
  CHECK(sum == Approx(31.1 + 104.9 + 105.6));
}

TEST_CASE("a participant explores both objects in each condition for equal times") {
  const Protocol protocol = experiment2();
  for (int session = 1; session <= 3; ++session) {
    for (int participant = 1; participant <= 12; ++participant) {
      const Plan plan = make_plan(protocol, participant, 4, session);
      CHECK(plan.trials.empty());
      CHECK(main_trial_count(plan) == 0);
      REQUIRE(plan.explorations.size() == 4);
      std::set<std::pair<int, int>> seen;
      for (std::size_t i = 0; i < 4; ++i) {
        const ExplorationSlot& slot = plan.explorations[i];
        CHECK(slot.index == static_cast<int>(i) + 1);
        CHECK(slot.block == static_cast<int>(i) / 2 + 1);
        CHECK(slot.duration_s == 150);
        CHECK(slot.condition == plan.explorations[i / 2 * 2].condition);
        CHECK(slot.object == plan.explorations[i % 2].object);  // the same order of objects in both conditions
        seen.insert({slot.condition, slot.object});
      }
      CHECK(seen.size() == 4);
    }
  }
}

TEST_CASE("conditions and objects come first equally often, each object in either condition's turn") {
  const Protocol protocol = experiment2();
  for (int session = 1; session <= 4; ++session) {
    std::map<std::pair<int, int>, int> first;  // condition and object that begin
    for (int participant = 1; participant <= 12; ++participant) {
      const ExplorationSlot slot = make_plan(protocol, participant, 21, session).explorations.front();
      ++first[{slot.condition, slot.object}];
    }
    REQUIRE(first.size() == 4);
    for (const auto& [begin, participants] : first) CHECK(participants == 3);
    const CohortBalance balance = balance_of_cohort(protocol, 12, 21, session);
    CHECK(balance.different_pairs_of_orders == 4);
    CHECK(balance.object_positions == std::vector<std::vector<int>>{{12, 12}, {12, 12}});
    CHECK(balance.condition_positions == std::vector<std::vector<int>>{{6, 6}, {6, 6}});
    CHECK(balance.group_size == 2);
    CHECK(balance.pair_count == 4);
    CHECK(to_text(balance, protocol).find("Exact: each order is used equally often by 12") != std::string::npos);
  }
  const Plan one = make_plan(protocol, 1, 21, 1), two = make_plan(protocol, 1, 21, 2);
  CHECK(one.explorations.front().condition == two.explorations.back().condition);
  CHECK(one.explorations.front().object == two.explorations.back().object);
}

TEST_CASE("three objects need six orders; random conditions are said to be so") {
  Protocol protocol = load_protocol(corpus_folder() / "good/explore.json");
  const CohortBalance balance = balance_of_cohort(protocol, 12, 2);
  CHECK(balance.group_size == 6);
  CHECK(balance.object_orders.size() == 6);
  for (const auto& row : balance.object_positions) CHECK(row == std::vector<int>{8, 8, 8});
  protocol.design.condition_order = Order::random;
  const CohortBalance drawn = balance_of_cohort(protocol, 12, 2);
  CHECK(drawn.group_size == 0);
  CHECK(to_text(drawn, protocol).find("balanced by chance only") != std::string::npos);
  protocol.explore.reset();
  CHECK_THROWS_AS(OrderAssignment(protocol, 1), std::invalid_argument);
}

TEST_CASE("the plan of free interaction never changes") {
  const Protocol protocol = experiment2();
  std::string text;
  for (int participant = 1; participant <= 8; ++participant)
    for (const ExplorationSlot& slot : make_plan(protocol, participant, 1).explorations)
      text += static_cast<char>('a' + 2 * slot.condition + slot.object);
  CHECK(text == "badccdababcddcbabadccdababcddcba");
}

TEST_CASE("free interaction takes its time, and the times of breaks and questions") {
  Protocol protocol = load_protocol(corpus_folder() / "good/explore.json");
  // Two conditions of 120 s, a break between them, a question after each and one at the end.
  CHECK(expected_duration_s(protocol) == Approx(2 * 120 + 60 + 3 * 10));
  protocol.breaks.clear();
  CHECK(expected_duration_s(protocol) == Approx(2 * 120 + 3 * 10));
}

TEST_CASE("a block of free interaction is never redone: only the interrupted object begins anew") {
  nlohmann::json json = nlohmann::json::parse(experiment2().bytes);
  json["resume"]["interrupted_block"] = "redo";
  try {
    parse_protocol(json.dump(), "p.json");
    FAIL("accepted");
  } catch (const InputError& error) {
    CHECK(std::string(error.what()).find("$.resume.interrupted_block") != std::string::npos);
  }
}
