// Device specifications, and protocols held against them.
#include <filesystem>
#include <fstream>

#include "examples.h"
#include "protocols/device_lint.h"
#include "protocols/device_spec.h"
#include "protocols/protocol_json.h"
#include "tests/catch.h"

using namespace jnd;
using namespace jnd::test;

namespace {

constexpr const char* kSpec = R"({
  "format": 1,
  "name": "rrs3",
  "title": "for tests",
  "limits": {
    "max_force_n": 4.7, "stroke_m": 0.015, "max_roll_rad": 0.628, "max_pitch_rad": 0.523,
    "max_joint_speed_rad_per_s": 10.4, "min_vibration_g": 0.05, "max_vibration_g": 1,
    "min_vibration_hz": 50, "max_vibration_hz": 240, "max_stiffness_n_per_m": 2000
  },
  "geometry": {"a_m": 0.006, "b_m": 0.01, "bh_m": 0.005, "bd_m": 0.0173205, "l1_m": 0.012, "l2_m": 0.02, "rest_z_m": -0.02}
})";

// A file that is gone when the test is over.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& text)
      : path_(std::filesystem::temp_directory_path() /
              ("jnd-spec-" + std::to_string(reinterpret_cast<std::uintptr_t>(this)) + ".json")) {
    std::ofstream(path_, std::ios::binary) << text;
  }
  ~TemporaryFile() { std::filesystem::remove(path_); }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

DeviceSpec spec_from(const std::string& text) {
  return load_device_spec(TemporaryFile(text).path());
}

std::string error_of(const std::string& text) {
  try {
    spec_from(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

Protocol shipped() {
  return load_protocol(protocols_folder() / "chinello2017.json");
}

}  // namespace

TEST_CASE("a device specification is read") {
  const DeviceSpec spec = spec_from(kSpec);
  CHECK(spec.name == "rrs3");
  CHECK(spec.max_force_n == 4.7);
  CHECK(spec.max_vibration_hz == 240);
  CHECK(spec.max_stiffness_n_per_m == 2000);
  CHECK(spec.l2_m == 0.02);
  CHECK(spec.rest_z_m == -0.02);
}

TEST_CASE("mistakes in a device specification are told") {
  CHECK(error_of(replaced(kSpec, "\"max_force_n\": 4.7", "\"max_force_n\": -1"))
            .find("$.limits.max_force_n: -1 is out of range") != std::string::npos);
  CHECK(error_of(replaced(kSpec, "\"a_m\"", "\"a_mm\"")).find("did you mean \"a_m\"") != std::string::npos);
  CHECK(error_of(replaced(kSpec, "\"min_vibration_g\": 0.05", "\"min_vibration_g\": 2"))
            .find("is below min_vibration_g") != std::string::npos);
  CHECK(error_of(replaced(kSpec, "\"min_vibration_hz\": 50", "\"min_vibration_hz\": 500"))
            .find("is below min_vibration_hz") != std::string::npos);
  CHECK(error_of("{").find("never closed") != std::string::npos);
  CHECK_THROWS_WITH(load_device_spec("/nowhere/at-all.json"), Catch::Contains("there is no such file"));
  CHECK_THROWS_WITH(load_device_spec(std::filesystem::temp_directory_path()), Catch::Contains("is a folder"));
}

TEST_CASE("depths and shares of saturation of the published design") {
  const Protocol protocol = shipped();
  const DeviceSpec spec = spec_from(kSpec);
  CHECK(depth_at_force_limit_m(500, spec) == Approx(0.00940).epsilon(1e-3));
  CHECK(depth_at_force_limit_m(600, spec) == Approx(0.00783).epsilon(1e-3));
  CHECK(depth_at_force_limit_m(700, spec) == Approx(0.00671).epsilon(1e-3));
  CHECK(depth_at_force_limit_m(900, spec) == Approx(0.00522).epsilon(1e-3));
  // Six presses of 5 +- 1 mm: 1 - Phi(0.222)^6, computed with an independent numpy model.
  CHECK(expected_saturated_intervals(900, protocol, spec) == Approx(0.959).margin(0.002));
  CHECK(expected_saturated_intervals(500, protocol, spec) < 1e-3);
  CHECK(burst_amplitude_g(900) == Approx(1.0));
}

TEST_CASE("the published design: saturation is a warning, in its place and with numbers") {
  const DeviceLint lint = lint_against_device(shipped(), spec_from(kSpec), "p.json");
  CHECK(lint.errors.empty());
  REQUIRE(lint.warnings.size() == 1);
  CHECK(lint.warnings[0].path == "$.stimulus.expected_press_m");
  CHECK(lint.warnings[0].line > 1);
  CHECK(lint.warnings[0].message.find("900 N/m at 5.22 mm, in 96 % of intervals") != std::string::npos);
}

TEST_CASE("repeating saturated trials is told to bias the study") {
  Protocol protocol = shipped();
  protocol.stimulus.on_saturation = OnSaturation::repeat;
  const DeviceLint lint = lint_against_device(protocol, spec_from(kSpec), "p.json");
  REQUIRE(lint.warnings.size() == 1);
  CHECK(lint.warnings[0].suggestion.find("bias the study") != std::string::npos);
}

TEST_CASE("shallow presses and soft spheres raise nothing") {
  Protocol protocol = shipped();
  protocol.stimulus.expected_press_m = 0.002;
  const DeviceLint lint = lint_against_device(protocol, spec_from(kSpec), "p.json");
  CHECK(lint.errors.empty());
  CHECK(lint.warnings.empty());
}

TEST_CASE("a pair whose vibrations clamp to one amplitude is an error where only vibration tells") {
  Protocol protocol = shipped();
  protocol.series[2].pair_n_per_m = {1200, 900};
  const DeviceLint lint = lint_against_device(protocol, spec_from(kSpec), "p.json");
  REQUIRE(lint.errors.size() == 1);
  CHECK(lint.errors[0].path == "$.series[2].pair");
  CHECK(lint.errors[0].message.find("in condition V both spheres vibrate with 1 g (1.200 and 1.000 g asked)") !=
        std::string::npos);
  bool told = false;
  for (const Diagnostic& warning : lint.warnings)
    told = told || warning.message.find("1200 N/m asks 1.200 g and gets 1 g") != std::string::npos;
  CHECK(told);

  protocol.conditions.erase(protocol.conditions.begin() + 1);  // without V, the force tells them apart
  CHECK(lint_against_device(protocol, spec_from(kSpec), "p.json").errors.empty());
}

TEST_CASE("stiffnesses beyond the device are errors, as are pairs that only meet the force limit") {
  Protocol protocol = shipped();
  protocol.series[0].pair_n_per_m = {2500, 900};
  const DeviceLint lint = lint_against_device(protocol, spec_from(kSpec), "p.json");
  REQUIRE_FALSE(lint.errors.empty());
  CHECK(lint.errors[0].path == "$.series[0].pair[0]");
  CHECK(lint.errors[0].message.find("2500 N/m is more than") != std::string::npos);

  DeviceSpec strong = spec_from(kSpec);
  strong.max_stiffness_n_per_m = 20000;
  protocol.series[0].pair_n_per_m = {6000, 4000};
  bool alike = false;
  for (const Diagnostic& error : lint_against_device(protocol, strong, "p.json").errors)
    alike = alike || error.message.find("in condition S both spheres reach the force limit") != std::string::npos;
  CHECK(alike);
}
