#include "protocols/planning/allotment.h"

#include <set>

#include "protocols/planning/plan.h"
#include "tests/catch.h"
#include "tests/protocols/examples.h"

using namespace jnd;

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
      CHECK(member_of(protocol, participant) == block + 1);
      for (const Trial& trial : plan.trials) CHECK(has_condition(protocol, plan.group, trial.condition));
    }
    CHECK(groups.size() == 3);
  }
  CHECK(first.size() > 1);
  protocol.allotment = Allotment::given;
  CHECK(group_of(protocol, number_of_member(protocol, 1, 4), 5) == 1);
  CHECK(member_of(protocol, number_of_member(protocol, 1, 4)) == 4);
}
