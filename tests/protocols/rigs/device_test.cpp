// Devices and rigs: their specifications, limits, and what a protocol asks of them.
#include <cmath>

#include <fmt/format.h>

#include "protocols/course/duration.h"
#include "protocols/input/input_error.h"
#include "protocols/input/sha256.h"
#include "protocols/planning/cohort.h"
#include "protocols/planning/plan.h"
#include "protocols/reading/protocol_json.h"
#include "protocols/rigs/device_models.h"
#include "protocols/rigs/rig_description.h"
#include "tests/catch.h"
#include "tests/protocols/bad_cases.h"
#include "tests/protocols/examples.h"
#include "tests/protocols/rigs.h"

using namespace jnd;
using namespace jnd::test;

namespace {

// Specifications of devices and rigs.

std::string rig_error_of(const std::string& text) {
  const TemporaryFolder folder;
  folder.write("rrs3.json", kRrs3Spec);
  folder.write("mckibben.json", kMckibbenSpec);
  try {
    load_rig_spec(folder.write("rig.json", text));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST_CASE("a specification of the 3RRS device is read") {
  const DeviceSpec spec = device_from(kRrs3Spec);
  CHECK(spec.name == "rrs3");
  CHECK(spec.model == DeviceModel::rrs3);
  CHECK(spec.unit == Unit::n_per_m);
  CHECK(spec.max_force_n == 4.7);
  CHECK(spec.max_vibration_hz == 240);
  CHECK(spec.max_stiffness == 2000);
  CHECK(spec.l2_m == 0.02);
  CHECK(spec.rest_z_m == -0.02);
  CHECK(spec.lowest_travel == Approx(-0.0275));
  CHECK(spec.highest_travel == Approx(-0.0125));
}

TEST_CASE("a specification of the McKibben finger is read") {
  const DeviceSpec spec = device_from(kMckibbenSpec);
  CHECK(spec.name == "mckibben");
  CHECK(spec.model == DeviceModel::mckibben);
  CHECK(spec.unit == Unit::n_per_rad);
  CHECK(spec.max_force_n == 20);
  CHECK(spec.max_stiffness == 50);
  CHECK(spec.lowest_travel == 0.35);
  CHECK(spec.highest_travel == 0.93);
  CHECK(spec.gains.ki == 3);
  CHECK(spec.tendon == Tendon::unilateral);
  CHECK(spec.lever_arm_m == 0.1);
  CHECK(spec.finger.c_m3_per_s_pa == 5.25e-9);
}

TEST_CASE("mistakes in a device specification are told") {
  CHECK(device_error(replaced(kRrs3Spec, "\"max_force_n\": 4.7", "\"max_force_n\": -1"))
            .find("$.limits.max_force_n: -1 is out of range") != std::string::npos);
  CHECK(device_error(replaced(kRrs3Spec, "\"a_m\"", "\"a_mm\"")).find("did you mean \"a_m\"") != std::string::npos);
  CHECK(device_error(replaced(kRrs3Spec, "\"min_vibration_g\": 0.05", "\"min_vibration_g\": 2"))
            .find("is below min_vibration_g") != std::string::npos);
  CHECK(device_error(replaced(kRrs3Spec, "\"min_vibration_hz\": 50", "\"min_vibration_hz\": 500"))
            .find("is below min_vibration_hz") != std::string::npos);
  CHECK(device_error("{").find("never closed") != std::string::npos);
  CHECK_THROWS_WITH(load_device_spec("/nowhere/at-all.json"), Catch::Contains("there is no such folder: /nowhere"));
  CHECK_THROWS_WITH(load_device_spec(std::filesystem::temp_directory_path()), Catch::Contains("is a folder"));
}

TEST_CASE("a device may say when it was calibrated, and for how long that holds") {
  const auto with = [](const std::string& members) {
    return replaced(kRrs3Spec, "\"format\": 1,", "\"format\": 1, " + members);
  };
  CHECK_FALSE(device_from(kRrs3Spec).calibration.has_value());
  const DeviceSpec spec = device_from(with("\"calibrated\": \"2024-02-29\", \"calibration_valid_days\": 90,"));
  REQUIRE(spec.calibration.has_value());
  CHECK(spec.calibration->date == std::chrono::sys_days(std::chrono::days(19'782)));
  CHECK(spec.calibration->valid_days == 90);
  CHECK_FALSE(device_from(with("\"calibrated\": \"2026-03-01\",")).calibration->valid_days.has_value());
  for (const char* date : {"2026-02-29", "2026-13-01", "2026-3-1", "01.03.2026", "2026-03-0x", "yesterday"})
    CHECK(device_error(with(std::string("\"calibrated\": \"") + date + "\",")).find("$.calibrated: is not a day") !=
          std::string::npos);
  CHECK(device_error(with("\"calibration_valid_days\": 90,")).find("counts from no day") != std::string::npos);
  CHECK(device_error(with("\"calibrated\": \"2026-03-01\", \"calibration_valid_days\": 0,")).find("out of range") !=
        std::string::npos);
}

TEST_CASE("mistakes in a specification of the McKibben finger are told") {
  CHECK(device_error(replaced(kMckibbenSpec, "\"min_angle_rad\": 0.35", "\"min_angle_rad\": 1"))
            .find("is not above min_angle_rad") != std::string::npos);
  CHECK(device_error(replaced(kMckibbenSpec, "\"kp\": 0.1, \"ki\": 3", "\"kp\": 0, \"ki\": 0"))
            .find("the controller would do nothing") != std::string::npos);
  CHECK(device_error(replaced(kMckibbenSpec, "\"unilateral\"", "\"rigid\"")).find("\"rigid\" is not known") !=
        std::string::npos);
  CHECK(device_error(replaced(kMckibbenSpec, ",\n  \"lever_arm_m\": 0.1", "")).find("\"lever_arm_m\" is missing") !=
        std::string::npos);
  CHECK(device_error(replaced(kMckibbenSpec, "\"valve_max_v\": 10", "\"valve_max_v\": 0.0"))
            .find("$.finger.valve_max_v") != std::string::npos);
}

TEST_CASE("a rig is one device, or two that act on one finger") {
  const RigSpec one = rig_named("rrs3");
  CHECK(one.name == "rrs3");
  REQUIRE(one.devices.size() == 1);
  CHECK(one.cutaneous() == &one.devices[0]);
  CHECK(one.kinaesthetic() == nullptr);
  CHECK(one.sha256 == sha256_hex(kRrs3Spec));

  const RigSpec joint = rig_named("mckibben");
  CHECK(joint.cutaneous() == nullptr);
  CHECK(joint.kinaesthetic() == &joint.devices[0]);

  const RigSpec both = rig_named("rrs3+mckibben");
  CHECK(both.name == "rrs3+mckibben");
  REQUIRE(both.devices.size() == 2);
  CHECK(both.cutaneous() == &both.devices[0]);
  CHECK(both.kinaesthetic() == &both.devices[1]);
  CHECK(both.lever_arm_m == 0.07);
  CHECK(both.sha256 == sha256_hex(std::string(kTwoDevicesSpec) + kRrs3Spec + kMckibbenSpec));
}

TEST_CASE("mistakes in a rig of two devices are told") {
  CHECK(rig_error_of(replaced(kTwoDevicesSpec, "\"cutaneous\": \"rrs3.json\"", "\"cutaneous\": \"mckibben.json\""))
            .find("$.cutaneous: mckibben.json acts on the joint") != std::string::npos);
  CHECK(rig_error_of(replaced(kTwoDevicesSpec, "\"mckibben.json\"", "\"../mckibben.json\""))
            .find("is not a file beside this one") != std::string::npos);
  CHECK(rig_error_of(replaced(kTwoDevicesSpec, "0.07", "0")).find("$.lever_arm_m: 0 is out of range") !=
        std::string::npos);
  CHECK(rig_error_of(replaced(kTwoDevicesSpec, "\"mckibben.json\"", "\"absent.json\"")).find("there is no such file") !=
        std::string::npos);
}

// No description of a device raises a limit above its model's hard one.

TEST_CASE("a description that asks for more than the model's hard limit is refused, and says what is allowed") {
  const auto refused = [](const char* spec, const char* key, const char* before, const char* asked, const char* hard) {
    const std::string error =
        device_error(replaced(spec, fmt::format("\"{}\": {}", key, before), fmt::format("\"{}\": {}", key, asked)));
    CAPTURE(key, error);
    CHECK(error.find(fmt::format("$.limits.{}: {}", key, asked)) != std::string::npos);
    CHECK(error.find(fmt::format("ever given, {}", hard)) != std::string::npos);
    CHECK(error.find("never raise it") != std::string::npos);
  };
  refused(kRrs3Spec, "max_force_n", "4.7", "12", "4.7 N");
  refused(kRrs3Spec, "stroke_m", "0.015", "0.03", "0.015 m");
  refused(kRrs3Spec, "max_roll_rad", "0.628", "0.7", "0.628319 rad");
  refused(kRrs3Spec, "max_vibration_g", "1", "1.5", "1 g");
  refused(kMckibbenSpec, "max_force_n", "20", "31", "30 N");
  refused(kMckibbenSpec, "max_stiffness_n_per_rad", "50", "500", "50 N/rad");
}

TEST_CASE("a lower limit is anybody's to set; what is no limit is 0") {
  CHECK(device_error(replaced(kRrs3Spec, "\"max_force_n\": 4.7", "\"max_force_n\": 2")).empty());
  CHECK(limit_in_force(2, 4.7) == 2);
  CHECK(limit_in_force(12, 4.7) == 4.7);
  CHECK(limit_in_force(-1, 4.7) == 0);
  CHECK(limit_in_force(std::nan(""), 4.7) == 0);
  CHECK(limit_in_force(INFINITY, 4.7) == 4.7);
}

// What a protocol asks of its rig, as it arrives in the record.

Protocol good(const std::string& name) {
  return load_protocol(corpus_folder() / "good" / (name + ".json"));
}

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

}  // namespace
