// What a protocol asks for, held against what a rig says that it can.
#include "devices/external/rig_fit.h"

#include "tests/catch.h"

using namespace jnd;

TEST_CASE("a protocol is held against the ranges of hello") {
  RigDemand demand{.quantity = "stiffness", .unit = "N/m", .values = {100, 1000}, .conditions = {{{"gain", 0.5}}}};
  RigHello hello;
  hello.quantities = {{"stiffness", "N/m", 100, 1000}};
  hello.parameters = {RigRange{"gain", "", 0, 2}};
  hello.measures = {{"force", "N"}};
  CHECK(rig_problems(demand, hello).empty());
  demand.values = {50, 50, 100};
  demand.conditions = {
      {{"gain", 3.0}}, {{"gain", std::string("high")}}, {{"gain", 1.0}, {"hand", std::string("left")}}};
  demand.real = true;
  CHECK(rig_problems(demand, hello) ==
        std::vector<std::string>{
            "50 N/m is out of the rig's range, stiffness 100 to 1000 N/m",
            "gain 3 is out of the rig's range, gain 0 to 2", "gain is a word here and a number for the rig",
            "the rig has no parameter hand: it has gain",
            "the rig is a model in software by its own word: what is felt with it is no real data"});
  // How long it may take to get ready belongs to the gap.
  RigHello slow = hello;
  slow.ready_s = 0.4;
  demand = {.quantity = "stiffness", .unit = "N/m", .values = {100}, .conditions = {{{"gain", 0.5}}}, .gap_s = 0.3};
  CHECK(rig_problems(demand, slow) ==
        std::vector<std::string>{
            "the rig needs up to 0.4 s to get ready for a value, and gap_s is 0.3 s: make it at least 0.4"});
  CHECK(rig_cautions(demand, slow).empty());
  demand.gap_s = 0.4;
  CHECK(rig_problems(demand, slow).empty());
  slow.holds = false;
  demand.gap_s = 0.1;
  CHECK(rig_problems(demand, slow).empty());
  REQUIRE(rig_cautions(demand, slow).size() == 1);
  CHECK(rig_cautions(demand, slow).front().find("same from different") != std::string::npos);
  // A limit on a peak is met by a channel, whose peak it is, or by one of that name; contacts every rig counts.
  RigHello measuring = hello;
  measuring.measures = {{"force", "N"}};
  demand = {.quantity = "stiffness",
            .unit = "N/m",
            .values = {100},
            .conditions = {{{"gain", 0.5}}},
            .measures = {"contacts", "peak_force"}};
  CHECK(rig_problems(demand, measuring).empty());
  measuring.measures = {{"peak_force", "N"}};
  CHECK(rig_problems(demand, measuring).empty());
  demand.measures = {"depth", "mean_speed"};
  CHECK(rig_problems(demand, measuring) ==
        std::vector<std::string>{
            "depth is held against limits, and the rig does not measure it: \"measures\" would say depth",
            "mean_speed is held against limits, and the rig does not measure it: \"measures\" would say mean_speed"});
  demand = {.quantity = "force", .unit = "N", .values = {1}};
  CHECK(rig_problems(demand, hello).front() == "the rig cannot present force: it presents stiffness");
  demand = {.quantity = "stiffness", .unit = "N/mm", .values = {1}};
  CHECK(rig_problems(demand, hello).front() == "stiffness is in N/mm here and in N/m for the rig");
}
