#include "protocols/planning/allotment.h"

#include <set>

#include "protocols/planning/cohort.h"
#include "protocols/planning/plan.h"
#include "protocols/planning/planned_precision.h"
#include "tests/catch.h"
#include "tests/protocols/examples.h"

using namespace jnd;

namespace {

Protocol with_groups(int groups) {
  Protocol protocol = small_protocol(2, 3, 4, Sampling::balanced);
  for (int group = 0; group < groups; ++group)
    protocol.groups.push_back({std::string(1, static_cast<char>('a' + group)), "a group", {0, 1, 2}});
  return protocol;
}

std::vector<int> groups_of(const Protocol& protocol, int participants, std::uint64_t seed) {
  std::vector<int> groups;
  for (int participant = 1; participant <= participants; ++participant)
    groups.push_back(group_of(protocol, participant, seed).value());
  return groups;
}

}  // namespace

TEST_CASE("the allotment of a seed never changes", "[allotment]") {
  // Computed with an independent Python model of Philox, the stream's name and the rule of this room's README.
  CHECK(groups_of(with_groups(3), 12, 1) == std::vector<int>{0, 1, 2, 0, 1, 2, 2, 1, 0, 2, 0, 1});
  CHECK(groups_of(with_groups(2), 12, 20171101) == std::vector<int>{0, 1, 0, 1, 0, 1, 1, 0, 0, 1, 0, 1});
  CHECK(groups_of(with_groups(6), 12, 18446744073709551615U) == std::vector<int>{0, 1, 4, 3, 5, 2, 1, 5, 3, 2, 4, 0});
  CHECK_FALSE(group_of(with_groups(0), 1, 1));
}

TEST_CASE("every block of participants has one of each group, who gets its conditions alone", "[allotment]") {
  Protocol protocol = small_protocol(2, 3, 4, Sampling::balanced);
  protocol.groups = {{"a", "A", {0, 1}}, {"b", "B", {1, 2}}, {"c", "C", {2}}};
  std::set<std::optional<int>> first;
  for (int block = 0; block < 12; ++block) {
    std::set<std::optional<int>> groups;
    for (int participant = 3 * block + 1; participant <= 3 * block + 3; ++participant) {
      const Plan plan = make_plan(protocol, participant, 5);
      groups.insert(plan.group);
      if (participant % 3 == 1) first.insert(plan.group);
      CHECK((participant - 1) / group_count(protocol) == block);
      CHECK(plan.conditions == conditions_of(protocol, plan.group));
      CHECK(plan.trials.size() == 8 * plan.conditions.size());
      for (const Trial& trial : plan.trials) CHECK(has_condition(protocol, plan.group, trial.condition));
    }
    CHECK(groups.size() == 3);
  }
  CHECK(first.size() > 1);
  CHECK(largest_plan(protocol) == 0);
  CHECK_FALSE(everyone_has_all(protocol));
  CHECK(anyone_has_both(protocol, 0, 1));
  CHECK_FALSE(anyone_has_both(protocol, 0, 2));
  CHECK(group_of(protocol, first_of(protocol, 2, 5), 5) == 2);
  protocol.allotment = Allotment::given;
  CHECK(group_of(protocol, number_of_member(protocol, 1, 4), 5) == 1);
  CHECK(number_of_member(protocol, 1, 4) == 3 * 3 + 2);
}

TEST_CASE("orders are balanced within each group, whichever numbers its members have", "[allotment]") {
  Protocol protocol = with_groups(2);
  protocol.design.condition_order = Order::permuted;
  protocol.groups[1].conditions = {0, 2};
  CHECK(balanced_at(protocol) == 12);
  for (const int group : {0, 1}) {
    const CohortBalance balance = balance_of_cohort(protocol, 12, 7, 1, group);
    CHECK(balance.participants == 6);
    REQUIRE(balance.condition_orders.size() == (group == 0 ? 6 : 2));
    for (const OrderUse& use : balance.condition_orders) CHECK(use.participants == (group == 0 ? 1 : 3));
    for (const CellBalance& cell : balance.cells) CHECK(cell.participants == 6);
    CHECK(balance.cells.size() == (group == 0 ? 6 : 4));
  }
  // What is drawn for a cell does not depend on the group.
  Protocol alone = protocol;
  alone.groups.clear();
  const auto stimuli_of = [](const Plan& plan) {
    std::vector<Intervals> stimuli;
    for (const Trial& trial : plan.trials)
      if (trial.condition == 2 && trial.series == 0) stimuli.push_back(trial.stimuli);
    return stimuli;
  };
  CHECK(stimuli_of(make_plan(protocol, 5, 7)) == stimuli_of(make_plan(alone, 5, 7)));
}

TEST_CASE("a planned precision is that of the contrasts and participants that there are", "[allotment]") {
  Protocol protocol = with_groups(3);
  protocol.design.participants = 18;
  CHECK(precision_question(protocol).participants == 18);
  CHECK(precision_note(protocol).empty());
  protocol.groups[0].conditions = {0, 1};
  protocol.groups[1].conditions = {0};
  protocol.groups[2].conditions = {1, 2};
  const PrecisionQuestion question = precision_question(protocol);
  CHECK(question.participants == 6);
  CHECK(question.contrasts.size() == 2);
  CHECK(precision_note(protocol).find("groups") != std::string::npos);
}
