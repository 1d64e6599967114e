// The shipped file of the McKibben finger, and what a geometry file must have.
#include <filesystem>
#include <fstream>
#include <vector>

#include "devices/mckibben/mckibben_device.h"
#include "protocols/input/json_reader.h"
#include "tests/catch.h"
#include "tests/devices/mckibben/mckibben_fixtures.h"

using namespace jnd;
using namespace jnd::testing;

TEST_CASE("the shipped geometry file has Table 1, and every key is required") {
  const std::filesystem::path path = std::filesystem::path(JND_SOURCE_DIR) / "devices/specs/mckibben.json";
  const DeviceSpec spec = load_device_spec(path);
  CHECK(spec.model == DeviceModel::mckibben);
  CHECK(spec.tendon == Tendon::unilateral);
  CHECK(spec.gains.kp == MckibbenOptions{}.gains.kp);
  CHECK(spec.gains.ki == MckibbenOptions{}.gains.ki);
  CHECK(spec.lowest_travel == Approx(straight_rad()).epsilon(1e-9));
  CHECK(spec.highest_travel == Approx(flexed_rad()).epsilon(1e-9));
  const MckibbenModel shipped(spec.finger, spec.tendon, spec.gains);
  const MckibbenModel table1 = mckibben_model(spec.gains, spec.tendon);
  CHECK(shipped.pose(0.6)->off_n() == table1.pose(0.6)->off_n());
  CHECK(shipped.pose(0.6)->pa_per_kg == table1.pose(0.6)->pa_per_kg);
  double lever = 0;
  for (int i = 0; i < 1000; ++i)
    lever +=
        table1.linkage().pose(straight_rad() + (flexed_rad() - straight_rad()) * (i + 0.5) / 1000)->tip_lever_m / 1000;
  CHECK(spec.lever_arm_m == Approx(lever).margin(1e-4));

  std::ifstream file(path);
  const nlohmann::json finger = nlohmann::json::parse(file).at("finger");
  CHECK(finger.size() == 33);
  for (const auto& [key, value] : finger.items()) {
    nlohmann::json less = finger;
    less.erase(key);
    std::vector<Diagnostic> diagnostics;
    const JsonNode node = parse_json(less.dump(), "finger.json");
    (void)read_mckibben_parameters(node, diagnostics, "finger.json");
    REQUIRE_FALSE(diagnostics.empty());
    CHECK(to_text(diagnostics.front()).find(key) != std::string::npos);
  }
  nlohmann::json unknown = finger;
  unknown["l6_m"] = 1;
  std::vector<Diagnostic> diagnostics;
  (void)read_mckibben_parameters(parse_json(unknown.dump(), "finger.json"), diagnostics, "finger.json");
  CHECK(diagnostics.size() == 1);
}
