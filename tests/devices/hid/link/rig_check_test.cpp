// What jnd doctor finds of a protocol's and a rig file's devices, trackers and buttons.
#include "devices/hid/link/rig_check.h"

#include <filesystem>
#include <fstream>
#include <string>

#include "devices/hid/buttons/button_mapping.h"
#include "devices/hid/firmware/jnd_report.h"
#include "tests/catch.h"
#include "tests/devices/hid/virtual/plant_fixtures.h"

using namespace jnd;

namespace {

SeenHid seen(unsigned usage, const std::string& serial, bool usable = true) {
  SeenHid one;
  one.info.path = "/dev/hidraw7";
  one.info.usage_page = JND_USAGE_PAGE;
  one.info.usage = static_cast<std::uint16_t>(usage);
  one.info.serial = serial;
  one.usable = usable;
  return one;
}
SeenHid tracker(const std::string& serial, bool usable = true) {
  return seen(JND_USAGE_TRACKER, serial, usable);
}

RigRequest asked(const std::string& tracker) {
  RigRequest request;
  request.fingers = {"thumb"};
  request.tracker = tracker;
  return request;
}

// The only finding.
Check of(const RigRequest& request, const RigFile* file, const std::vector<SeenHid>& seen = {}) {
  const Checks checks = check_rig(&request, file, seen);
  REQUIRE(checks.size() == 1);
  CHECK((checks[0].verdict == Verdict::ok) == checks[0].what_to_do.empty());
  return checks[0];
}

bool says(const Check& check, const std::string& part) {
  INFO(check.found);
  return check.found.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("without a protocol and a rig file nothing is said") {
  CHECK(check_rig(nullptr, nullptr, {tracker("TR-1")}).empty());
}

TEST_CASE("a tracker on HID must be connected and usable, and the one of the rig file") {
  CHECK(of(asked("hand"), nullptr).verdict == Verdict::ok);
  CHECK(of(asked("encoder"), nullptr).verdict == Verdict::ok);
  CHECK(says(of(asked("hid"), nullptr), "none is connected"));
  CHECK(of(asked("hid"), nullptr, {seen(JND_USAGE_FINGERTIP, "FT-1")}).verdict == Verdict::bad);
  const Check refused = of(asked("hid"), nullptr, {tracker("TR-1", false)});
  CHECK(refused.verdict == Verdict::bad);
  CHECK(says(refused, "may not use TR-1"));
  const Check found = of(asked("hid"), nullptr, {tracker("TR-1", false), tracker("TR-2")});
  CHECK(found.verdict == Verdict::ok);
  CHECK(found.found == "\"hid\": TR-2 connected");
  RigFile file;
  file.tracker.serial = "TR-1";
  CHECK(of(asked("hid"), &file, {tracker("TR-1"), tracker("TR-2")}).found == "\"hid\": TR-1 connected");
  CHECK(says(of(asked("hid"), &file, {tracker("TR-2")}), "TR-1 is not connected"));
}

TEST_CASE("a program that writes poses must be there, where a session would look for it") {
  CHECK(of(asked("process"), nullptr).verdict == Verdict::warn);
  RigFile file;
  CHECK(says(of(asked("process"), &file), "does not say which program"));
  file.tracker.command = {"sh", "-c", "true"};
  CHECK(of(asked("process"), &file).verdict == Verdict::ok);
  file.tracker.command = {"jnd-no-such-bridge"};
  CHECK(says(of(asked("process"), &file), "no program jnd-no-such-bridge"));

  const testing::TemporaryFolder folder;
  file.tracker.folder = folder.path;
  file.tracker.command = {"./bridge"};
  CHECK(of(asked("process"), &file).verdict == Verdict::bad);
  std::ofstream(folder.path / "bridge") << "#!/bin/sh\n";
  CHECK(of(asked("process"), &file).verdict == Verdict::bad);  // not executable
  std::filesystem::permissions(folder.path / "bridge", std::filesystem::perms::owner_all);
  CHECK(of(asked("process"), &file).verdict == Verdict::ok);
}

TEST_CASE("a replay is read to its end") {
  RigFile file;
  CHECK(of(asked("replay"), nullptr).verdict == Verdict::warn);
  CHECK(says(of(asked("replay"), &file), "does not say which file"));
  const testing::TemporaryFolder folder;
  file.tracker.replay = folder.path / "poses.txt";
  CHECK(says(of(asked("replay"), &file), "no such file of poses"));
  std::ofstream(file.tracker.replay) << "jnd-poses 1 units=m clock=source\n"
                                        "thumb 0.000 0 0 0 1 0 0 0\nthumb 0.005 0 0 0 1 0 0 0\n";
  CHECK(says(of(asked("replay"), &file), "2 poses"));
  std::ofstream(file.tracker.replay, std::ios::app) << "thumb 0.010 0 0 0 1 0 0\nthumb 0.015 0\n";
  const Check wrong = of(asked("replay"), &file);
  CHECK(wrong.verdict == Verdict::bad);
  CHECK(says(wrong, "poses.txt:4:1: seven finite numbers"));
  CHECK(says(wrong, "; "));
  CHECK_FALSE(says(wrong, "\n"));
}

TEST_CASE("the rig file's devices must be connected and usable") {
  RigFile file;
  file.devices = {{.finger = "thumb", .serial = "FT-1"}, {.finger = "index", .serial = "FT-2"}};
  const auto check = [&file](const std::vector<SeenHid>& seen) {
    const Checks checks = check_rig(nullptr, &file, seen);
    REQUIRE(checks.size() == 1);
    return checks[0];
  };
  const SeenHid first = seen(JND_USAGE_FINGERTIP, "FT-1"), second = seen(JND_USAGE_FINGERTIP, "FT-2");
  CHECK(check({first, second}).verdict == Verdict::ok);
  CHECK(check({first, tracker("FT-2")}).found == "not connected: FT-2 (index)");
  CHECK(check({first, seen(JND_USAGE_FINGERTIP, "FT-2", false)}).found == "this login may not use FT-2 (index)");
}

TEST_CASE("the rig file's buttons must be learnt and connected") {
  const testing::TemporaryFolder folder;
  RigFile file;
  file.buttons = folder.path / "pedals.json";
  const auto check = [&file](const std::vector<SeenHid>& seen) {
    const Checks checks = check_rig(nullptr, &file, seen);
    REQUIRE(checks.size() == 1);
    CHECK(checks[0].what == "buttons");
    return checks[0];
  };
  CHECK(check({}).verdict == Verdict::bad);
  ButtonMapping mapping;
  mapping.vendor = 0x05f3;
  mapping.product = 0x00ff;
  mapping.usage_page = 0x0c;
  mapping.usage = 0x03;
  mapping.name = "Foot pedal";
  mapping.report_bytes = 1;
  mapping.buttons = {{.meaning = ButtonMeaning::same, .where = ButtonBits{.byte = 0, .mask = 1, .pressed = 1}},
                     {.meaning = ButtonMeaning::different, .where = ButtonBits{.byte = 0, .mask = 2, .pressed = 2}}};
  std::ofstream(file.buttons) << to_json(mapping);
  CHECK(check({}).found == "Foot pedal is not connected");
  SeenHid pedal;
  pedal.info.vendor = mapping.vendor;
  pedal.info.product = mapping.product;
  pedal.info.usage_page = mapping.usage_page;
  pedal.info.usage = mapping.usage;
  CHECK(check({pedal}).found == "this login may not use Foot pedal");
  pedal.usable = true;
  CHECK(check({pedal}).verdict == Verdict::ok);
}

TEST_CASE("a device that is a program must be served where the rig file says, or there to be started") {
  RigFile file;
  file.devices = {{.finger = "thumb", .serial = "", .socket = "/run/thumb.sock"}};
  const auto devices = [&file](const std::vector<SeenHid>& seen) { return check_rig(nullptr, &file, seen).at(0); };
  SeenHid served = seen(JND_USAGE_FINGERTIP, "FT-1");
  CHECK(devices({served}).verdict == Verdict::bad);  // another one
  served.info.path = "/run/thumb.sock";
  CHECK(devices({served}).verdict == Verdict::ok);
  CHECK(says(devices({}), "not connected: /run/thumb.sock (thumb)"));
  file.devices.push_back({.finger = "index", .serial = "", .socket = {}, .command = {"sh"}});
  CHECK(says(devices({served}), "/run/thumb.sock (thumb) connected; a session starts sh (index)"));
  file.devices[1].command = {"jnd-no-such-program"};
  CHECK(says(devices({served}), "no program jnd-no-such-program (index)"));
  file.devices.clear();
  file.tracker.socket = "/run/tracker.sock";
  SeenHid poses = tracker("TR-1");
  CHECK(of(asked("hid"), &file, {poses}).verdict == Verdict::bad);
  poses.info.path = "/run/tracker.sock";
  CHECK(of(asked("hid"), &file, {poses}).verdict == Verdict::ok);
}
