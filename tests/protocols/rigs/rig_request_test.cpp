// What a protocol asks of its rig, as it arrives in the record.
#include "protocols/course/duration.h"
#include "protocols/planning/cohort.h"
#include "protocols/planning/plan.h"
#include "protocols/reading/protocol_json.h"
#include "tests/catch.h"
#include "tests/protocols/bad_cases.h"
#include "tests/protocols/examples.h"

using namespace jnd;
using namespace jnd::test;

namespace {

Protocol good(const std::string& name) {
  return load_protocol(corpus_folder() / "good" / (name + ".json"));
}

}  // namespace

TEST_CASE("a rig of fingertip devices is read") {
  const Protocol complete = good("complete");
  CHECK(complete.rig.device == "rrs3");
  CHECK(complete.rig.tracker == "hand");
  CHECK(complete.rig.mode == RenderingMode::wrench);
  CHECK(complete.rig.object.empty());
  CHECK(complete.rig.sphere_radius_m == 0.04);
  CHECK(complete.stimulus.unit == Unit::n_per_m);
  CHECK(complete.stimulus.damping_n_s_per_m == 0.5);
  CHECK(complete.analysis.by_delivered);
  const Protocol minimal = good("minimal");
  CHECK(minimal.rig.mode == RenderingMode::wrench);
  CHECK(minimal.stimulus.damping_n_s_per_m == 0);
  CHECK_FALSE(minimal.analysis.by_delivered);
  const Protocol object = good("object");
  CHECK(object.rig.object == "teddy-bear");
  CHECK(object.rig.mode == RenderingMode::pd_literal);
}

TEST_CASE("a rig that drives a joint is read") {
  const Protocol joint = good("joint");
  CHECK(joint.rig.device == "mckibben");
  CHECK(joint.rig.tracker == "encoder");
  CHECK(joint.rig.contact_flexion_rad == 0.1);
  CHECK(joint.stimulus.unit == Unit::n_per_rad);
  CHECK(joint.stimulus.reference == 25);
  CHECK(joint.stimulus.expected_press == 0.25);
  CHECK(joint.stimulus.damping_n_s_per_m == 0.01);
  CHECK(joint.conditions.at(0).cues == Cues{.kinaesthetic = true});
  CHECK_FALSE(joint.analysis.by_delivered);
  const Protocol both = good("two-devices");
  CHECK(both.rig.device == "rrs3+mckibben");
  CHECK(both.rig.mode == RenderingMode::pd);
  CHECK(both.stimulus.unit == Unit::n_per_m);
  CHECK(both.conditions.at(0).cues == Cues{.force = true, .vibration = true, .kinaesthetic = true});
}

TEST_CASE("the trials of a joint's protocol carry its unit, and its tables name it") {
  for (const char* const name : {"joint", "two-devices"}) {
    const Protocol protocol = good(name);
    const Plan plan = make_plan(protocol, 1, 1);
    REQUIRE_FALSE(plan.trials.empty());
    for (const Trial& trial : plan.trials) CHECK(trial.unit == protocol.stimulus.unit);
    const std::string text = to_text(balance_of_cohort(protocol, protocol.design.participants, 1), protocol);
    const bool in_metres = protocol.stimulus.unit == Unit::n_per_m;
    CHECK((text.find("N/m") != std::string::npos) == in_metres);
    CHECK((text.find("N/rad") != std::string::npos) == !in_metres);
  }
}

TEST_CASE("messages about a joint's stiffnesses are in N/rad") {
  const std::map<std::string, BadCase> cases = bad_cases();
  for (const char* const name : {"pair-identical-joint", "reference-elsewhere-joint", "pair-too-stiff-joint"}) {
    CAPTURE(name);
    const ProtocolCheck check = check_protocol(cases.at(name).text, "p.json");
    REQUIRE(check.errors.size() == 1);
    CHECK(to_text(check.errors[0]).find("N/rad") != std::string::npos);
    CHECK(to_text(check.errors[0]).find("N/m") == std::string::npos);
  }
}

TEST_CASE("shipped protocols of the joint take the time that their notes say") {
  CHECK(expected_duration_s(load_protocol(protocols_folder() / "mckibben-stiffness.json")) ==
        Approx(25 * 60).epsilon(0.15));
  CHECK(expected_duration_s(load_protocol(protocols_folder() / "cutaneous-kinaesthetic.json")) ==
        Approx(55 * 60).epsilon(0.1));
}

TEST_CASE("where fingers in space are may come from four trackers, and a missing one is told with those that fit") {
  for (const std::string word : {"hid", "process", "replay"}) CHECK(good("tracker-" + word).rig.tracker == word);
  const auto suggestion = [](const char* name, const std::string& member) {
    std::string text = read_text(corpus_folder() / "good" / (std::string(name) + ".json"));
    const std::size_t at = text.find(member);
    REQUIRE(at != std::string::npos);
    const ProtocolCheck check = check_protocol(text.erase(at, member.size()), "p.json");
    REQUIRE(check.errors.size() == 1);
    CHECK(check.errors[0].path == "$.rig.tracker");
    return check.errors[0].suggestion;
  };
  CHECK(suggestion("minimal", "\"tracker\": \"hand\",") == R"(add "hand", "hid", "process" or "replay")");
  CHECK(suggestion("joint", "\"tracker\": \"encoder\",") == R"(add "encoder")");
}
