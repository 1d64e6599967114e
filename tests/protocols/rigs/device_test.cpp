// Specifications of devices and rigs.
#include "protocols/input/sha256.h"
#include "protocols/rigs/rig_description.h"
#include "tests/catch.h"
#include "tests/protocols/examples.h"
#include "tests/protocols/rigs.h"

using namespace jnd;
using namespace jnd::test;

namespace {

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

}  // namespace

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
