// The virtual tracker and button box without a kernel, and the descriptors of all three.
#include <fstream>
#include <map>
#include <sstream>

#include <nlohmann/json.hpp>

#include "devices/hid/virtual/virtual_buttons.h"
#include "devices/hid/virtual/virtual_device.h"
#include "devices/hid/virtual/virtual_tracker.h"
#include "protocols/input/input_error.h"
#include "tests/catch.h"
#include "tests/devices/hid/virtual/plant_fixtures.h"
#include "tests/units.h"

using namespace jnd;
using namespace jnd::testing;

TEST_CASE("the tracker's fingers close, press five millimetres three times, open and begin again") {
  Cable cable;
  VirtualTracker tracker({.rate_hz = 1000}, cable.end());
  RepeatedPresses motion(2);
  const auto cycle_ms = static_cast<int>(motion.cycle_ns() / kMs);
  for (int ms = 1; ms <= 2 * cycle_ms; ++ms) tracker.step(ms * kMs, false);
  const auto poses = cable.poses();
  REQUIRE(poses.size() == static_cast<std::size_t>(4 * cycle_ms));
  double deepest = 0, fastest = 0, widest = 0;
  int contacts = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    CHECK(poses[i].sequence == i + 1);
    CHECK(poses[i].seen);
    CHECK(poses[i].finger == (i % 2 == 0 ? JND_THUMB : JND_INDEX));
    const double depth = 0.040 - 1e-9 * std::abs(poses[i].position_nm[0]);
    deepest = std::max(deepest, depth);
    widest = std::max(widest, -depth);
    CHECK((poses[i].position_nm[0] < 0) == (poses[i].finger == JND_THUMB));
    if (i < 2) continue;
    const double before = 0.040 - 1e-9 * std::abs(poses[i - 2].position_nm[0]);
    fastest = std::max(fastest, std::abs(depth - before) / 0.001);
    if (i % 2 == 0 && before <= 0 && depth > 0) ++contacts;
  }
  CHECK(deepest == Approx(0.005).epsilon(1e-3));
  CHECK(widest == Approx(0.025).epsilon(1e-3));
  CHECK(fastest < 0.15);  // m/s: without a jump, at the end of a cycle neither
  CHECK(contacts == 6);
  // The same in the second cycle.
  for (std::size_t i = 0; i + 2 * static_cast<std::size_t>(cycle_ms) < poses.size(); ++i)
    if (motion.cycle_ns() % kMs == 0)
      REQUIRE(poses[i].position_nm[0] == poses[i + 2 * static_cast<std::size_t>(cycle_ms)].position_nm[0]);
}

TEST_CASE("the tracker loses its fingers, drops poses, and answers for itself") {
  Cable cable;
  VirtualTracker tracker({.fingers = {JND_MIDDLE}, .rate_hz = 100}, cable.end());
  CHECK(tracker.period_ns() == 10 * kMs);
  tracker.step(10 * kMs, false);
  CHECK(tracker.obey(parse_order("lose")));
  tracker.step(20 * kMs, false);
  CHECK(tracker.obey(parse_order("lose off")));
  CHECK(tracker.obey(parse_order("drop 1")));
  tracker.step(30 * kMs, false);
  tracker.step(40 * kMs, true);
  tracker.step(50 * kMs, false);
  const auto poses = cable.poses();
  REQUIRE(poses.size() == 3);
  CHECK(poses[0].finger == JND_MIDDLE);
  CHECK(poses[0].time_us == 10'000);
  CHECK_FALSE(poses[1].seen);
  CHECK(poses[2].sequence == 4);
  CHECK_FALSE(tracker.obey(parse_order("hot")));
  const auto ask = [&](std::uint8_t page, std::uint8_t operation) {
    jnd_request request{};
    request.operation = operation;
    request.page = page;
    Report bytes{};
    jnd_encode_request(&request, bytes.data());
    tracker.receive(bytes, 0);
    return cable.answers().back();
  };
  const jnd_answer identity_page = ask(JND_PAGE_IDENTITY, JND_READ_PAGE);
  CHECK(identity_page.result == JND_PAGE_OK);
  jnd_identity identity{};
  REQUIRE(jnd_decode_identity(identity_page.data, &identity));
  CHECK(identity.model == JND_MODEL_TRACKER);
  CHECK(identity.finger == JND_MIDDLE);
  CHECK(identity.loop_rate_hz == 100);
  CHECK(ask(JND_PAGE_LIMITS, JND_READ_PAGE).result == JND_PAGE_UNKNOWN);
  CHECK(ask(JND_PAGE_IDENTITY, JND_WRITE_PAGE).result == JND_PAGE_REFUSED);
  CHECK_THROWS_AS(RepeatedPresses(3), InputError);
  CHECK_THROWS_AS(VirtualTracker({.rate_hz = 0}, cable.end()), InputError);
  CHECK(nlohmann::json::parse("{" + tracker.status() + "}")["sent"] == 3);
}

TEST_CASE("the button box tells each change once") {
  Cable cable;
  VirtualButtons box("VB-1", cable.end());
  box.step(1, false);
  CHECK(cable.reports.empty());
  CHECK(box.obey(parse_order("button 1")));
  box.step(2, false);
  box.step(3, false);
  CHECK(box.obey(parse_order("button 8")));
  box.step(4, false);
  CHECK(box.obey(parse_order("button 1 off")));
  box.step(5, true);
  box.step(6, false);
  CHECK(cable.reports == std::vector<std::vector<std::uint8_t>>{{128, 128, 1}, {128, 128, 129}, {128, 128, 128}});
  CHECK_FALSE(box.obey(parse_order("hot")));
  CHECK(nlohmann::json::parse("{" + box.status() + "}")["buttons"] == 128);
}

TEST_CASE("the report descriptors are those of the protocol's page") {
  std::ifstream page(std::filesystem::path(JND_SOURCE_DIR) / "devices/hid/PROTOCOL.md");
  std::map<std::string, std::vector<std::uint8_t>> printed;
  std::string name;
  for (std::string line; std::getline(page, line);) {
    if (line.rfind("```", 0) == 0) {
      name = line.rfind("```descriptor ", 0) == 0 ? line.substr(14) : "";
    } else if (!name.empty()) {
      std::istringstream bytes(line.substr(0, 16));
      for (unsigned byte = 0; bytes >> std::hex >> byte;) printed[name].push_back(static_cast<std::uint8_t>(byte));
    }
  }
  CHECK(printed["fingertip"] == fingertip_descriptor());
  CHECK(printed["tracker"] == tracker_descriptor());
}
