// A rig over HID, and what is checked of it.
#include "devices/hid/link/hid_rig.h"

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "devices/device_error.h"
#include "devices/hid/buttons/button_mapping.h"
#include "devices/hid/firmware/jnd_report.h"
#include "devices/hid/link/fingertip_link.h"
#include "devices/hid/link/rig_check.h"
#include "devices/rigs/rig_factory.h"
#include "protocols/input/input_error.h"
#include "tests/catch.h"
#include "tests/counted_heap.h"
#include "tests/devices/device_fixtures.h"
#include "tests/devices/hid/link/link_fixtures.h"
#include "tests/devices/hid/virtual/plant_fixtures.h"
#include "tests/text_checks.h"

using namespace jnd;
using namespace jnd::testing;

namespace {

// A whole rig over HID beside the simulated one.

struct TwoFingers {
  TwoFingers() {
    bus.add(jnd_fingertip_default_config("RRS3-0001", JND_THUMB), shipped_rrs3());
    bus.add(jnd_fingertip_default_config("RRS3-0002", JND_INDEX), shipped_rrs3());
  }
  std::unique_ptr<Rig> rig(const RigFile& file = {},
                           std::chrono::milliseconds longest_wait = std::chrono::minutes(10)) {
    return make_hid_rig(protocol, rrs3_rig(), file, profile, 1, kSeed, bus, bus, {}, longest_wait);
  }
  static constexpr std::uint64_t kSeed = 42;
  MemoryBus bus;
  Protocol protocol = small_protocol();
  ParticipantProfile profile = shipped_profile("chinello2017");
};

// Of a device that is not there: nothing is waited for.
std::string error_of(TwoFingers& scene, const RigFile& file = {}, int longest_wait_ms = 0) {
  try {
    (void)scene.rig(file, std::chrono::milliseconds(longest_wait_ms));
  } catch (const DeviceError& error) {
    return std::string("DeviceError: ") + error.what();
  } catch (const InputError& error) {
    return std::string("InputError: ") + error.what();
  }
  return "none";
}

TEST_CASE("the same interval feels the same over HID and simulated", "[hid_rig]") {
  TwoFingers scene;
  for (const RenderingMode mode : {RenderingMode::wrench, RenderingMode::pd, RenderingMode::pd_literal}) {
    CAPTURE(to_string(mode));
    scene.protocol.rig.mode = mode;
    const std::unique_ptr<Rig> real = scene.rig();
    SimulatedClock clock(0);
    const std::unique_ptr<Rig> simulated =
        make_simulated_rig(scene.protocol, rrs3_rig(), scene.profile, 1, TwoFingers::kSeed, clock);
    for (int trial = 1; trial <= (mode == RenderingMode::wrench ? 2 : 1); ++trial) {
      PresentRequest asked = request(trial == 1 ? 300 : 700, kBoth, {.trial = trial});
      asked.explore_s = 0.7;
      const Presentation over_hid = real->present(asked), model = simulated->present(asked);
      REQUIRE(over_hid.fault == Fault::none);
      REQUIRE(model.fault == Fault::none);
      REQUIRE(over_hid.fingers.size() == 2);
      CHECK(over_hid.first_contact_s == Approx(model.first_contact_s).margin(0.002));
      for (std::size_t finger = 0; finger < 2; ++finger) {
        const FingerPresentation &is = over_hid.fingers[finger], &was = model.fingers[finger];
        REQUIRE(is.stiffness);
        REQUIRE(was.stiffness);
        CHECK(*is.stiffness == Approx(*was.stiffness).epsilon(0.02));
        CHECK(is.peak_force_n == Approx(was.peak_force_n).epsilon(0.02));
        CHECK(is.deepest_penetration == Approx(was.deepest_penetration).epsilon(0.01));
        CHECK(is.vibration_g == Approx(was.vibration_g).epsilon(0.01));
        CHECK(is.contacts == was.contacts);
      }
    }
    const RigConnections all = real->connections();
    REQUIRE(all.devices.size() == 2);
    for (const DeviceLinkReport& device : all.devices) {
      CHECK(device.missing == 0);
      CHECK(device.damaged == 0);
      CHECK(device.rejected == 0);
      CHECK(device.sent > 700);
    }
  }
}

TEST_CASE("a rig over HID says what it is", "[hid_rig]") {
  TwoFingers scene;
  const std::unique_ptr<Rig> rig = scene.rig();
  CHECK(rig->info().name == "rrs3 (HID) x 2");
  CHECK(rig->info().mode == "wrench");
  CHECK(rig->info().tracker == "hand");
  CHECK(rig->info().simulated);
  CHECK(rig->info().sha256 != rrs3_rig().spec.sha256);
  CHECK(rig->missing().empty());
  CHECK(rig->connections().devices[0].serial == "RRS3-0001");
  CHECK(rig->connections().devices[0].finger == "thumb");
  CHECK(rig->connections().devices[1].serial == "RRS3-0002");
  Protocol tracked = scene.protocol;
  tracked.rig.tracker = "hid";
  CHECK_FALSE(hid_rig_info(tracked, rrs3_rig().spec).simulated);
  tracked.rig.tracker = "process";
  CHECK_FALSE(hid_rig_info(tracked, rrs3_rig().spec).simulated);
  tracked.rig.tracker = "replay";
  CHECK(hid_rig_info(tracked, rrs3_rig().spec).simulated);
}

TEST_CASE("which device a finger wears: by its serial, or by what it is made for", "[hid_rig]") {
  TwoFingers scene;
  RigFile file;
  file.devices = {{"thumb", "RRS3-0001"}, {"index", ""}};
  CHECK(scene.rig(file)->connections().devices[1].serial == "RRS3-0002");
  file.devices = {{"thumb", "RRS3-0002"}, {"index", "RRS3-0001"}};
  // As soon as the link has asked the device.
  CHECK(wait_until([&] { return contains(error_of(scene, file, 100), "made for the index finger"); }));
  file.devices = {{"thumb", "RRS3-0001"}};
  CHECK(contains(error_of(scene, file), "InputError: the rig file names no device for the index finger"));
  scene.bus.add(jnd_fingertip_default_config("RRS3-0003", JND_INDEX), shipped_rrs3());
  CHECK(contains(error_of(scene), "RRS3-0002 and RRS3-0003 both fit the index finger"));
  scene.bus.unplug(1);
  CHECK(scene.rig()->connections().devices[1].serial == "RRS3-0003");
}

TEST_CASE("what is missing is named, with what is connected and what to do", "[hid_rig]") {
  TwoFingers scene;
  scene.bus.unplug(1);
  const std::string said = error_of(scene);
  CHECK(contains(said, "DeviceError: no device for the index finger"));
  CHECK(contains(said, "RRS3-0001 (thumb)"));
  CHECK(contains(said, "70-jnd.rules"));
  scene.bus.unplug(0);
  CHECK(
      contains(error_of(scene), "no device for the thumb and the index finger is connected (connected: none of ours)"));
}

TEST_CASE("unplugged in the middle of a presentation: stopped, named, and gone on with", "[hid_rig]") {
  TwoFingers scene;
  const std::unique_ptr<Rig> rig = scene.rig();
  PresentRequest asked = request(500, kForce);
  asked.explore_s = 60;
  std::thread hand([&] {
    (void)wait_until(
        [&] { return scene.bus.with(0, [](const MemoryDevice& device) { return device.force_n() > 0.5; }); });
    scene.bus.unplug(1);
  });
  const Presentation cut = rig->present(asked);
  hand.join();
  CHECK(cut.fault == Fault::device_lost);
  CHECK(contains(rig->missing(), "RRS3-0002"));
  CHECK_FALSE(rig->connections().devices[1].connected);
  // The other finger's device was stopped with it.
  CHECK(wait_until([&] {
    return scene.bus.with(0, [](const MemoryDevice& device) { return device.firmware().state == JND_STATE_REST; });
  }));
  asked.explore_s = 0.5;
  CHECK(rig->present(asked).fault == Fault::device_lost);
  scene.bus.plug(1);
  REQUIRE(wait_until([&] { return rig->missing().empty(); }));
  CHECK(rig->present(asked).fault == Fault::none);
  CHECK(rig->connections().devices[1].reconnections == 1);
}

TEST_CASE("the stop button on a device stops all of them, and only a person's word goes on", "[hid_rig]") {
  TwoFingers scene;
  const std::unique_ptr<Rig> rig = scene.rig();
  PresentRequest asked = request(500, kForce);
  asked.explore_s = 60;
  std::thread hand([&] {
    (void)wait_until(
        [&] { return scene.bus.with(0, [](const MemoryDevice& device) { return device.force_n() > 0.5; }); });
    scene.bus.with(1, [](MemoryDevice& device) { device.stop_button = true; });
  });
  const Presentation cut = rig->present(asked);
  hand.join();
  CHECK(cut.fault == Fault::emergency_stop);
  CHECK(cut.stopped_by == "button");
  CHECK(rig->stop.source() == StopSource::button);
  CHECK(wait_until([&] {
    return scene.bus.with(0, [](const MemoryDevice& device) { return device.firmware().state == JND_STATE_REST; });
  }));
  scene.bus.with(1, [](MemoryDevice& device) { device.stop_button = false; });
  REQUIRE(wait_until([&] {
    rig->neutral();  // at rest it forgets
    return rig->missing().empty();
  }));
  asked.explore_s = 0.5;
  CHECK(rig->present(asked).fault == Fault::emergency_stop);  // letting go of it clears nothing
  rig->stop.clear();
  CHECK(rig->present(asked).fault == Fault::none);
}

TEST_CASE("a rig that HID cannot be is refused", "[hid_rig]") {
  TwoFingers scene;
  scene.protocol.rig.device = "mckibben";
  CHECK_THROWS_AS(make_hid_rig(scene.protocol, shipped_rig("mckibben"), {}, scene.profile, 1, 1, scene.bus, scene.bus),
                  InputError);
  CHECK_THROWS_AS(make_hid_rig(scene.protocol, rrs3_rig(), {}, scene.profile, 1, 1, scene.bus, scene.bus), InputError);
}

// What jnd doctor finds of a protocol's and a rig file's devices, trackers and buttons.

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

// What the control loop calls of a device over HID neither allocates nor frees: counted at malloc itself.

TEST_CASE("the loop's calls of a device over HID allocate nothing", "[link]") {
  if (!counts_heap_calls) {
    WARN("SKIPPED: allocations are not counted under AddressSanitizer or ThreadSanitizer, or without glibc");
    return;
  }
  {
    const std::int64_t before = heap_calls;
    void* volatile block = std::malloc(5);
    std::free(block);
    REQUIRE(heap_calls - before == 2);  // it counts
  }
  MemoryBus bus;
  bus.add(jnd_fingertip_default_config("RRS3-0001", JND_INDEX), shipped_rrs3());
  FingertipLink link(bus, target_of("RRS3-0001", "index"), bus);
  REQUIRE(wait_until([&] { return link.connection() == 1; }));
  HidFingertip device(link, RenderingMode::wrench);
  DeviceCommand press;
  press.stiffness_n_per_m = 500;
  press.penetration_m = 0.002;
  press.force_n = 4;
  DeviceReading reading;
  std::int64_t calls = 0;
  int wrong = 0;
  for (int interval = 0; interval < 3; ++interval) {
    for (int tick = 0; tick < 300; ++tick) {
      const std::int64_t before = heap_calls;
      if (tick == 0 && device.engage(bus.now_ns()) != DeviceStatus::ok) ++wrong;
      if (device.read(bus.now_ns(), reading) != DeviceStatus::ok) ++wrong;
      if (device.write(press, bus.now_ns()) != DeviceStatus::ok) ++wrong;
      if (tick == 299) device.neutral();
      calls += heap_calls - before;
      bus.sleep_until_ns(bus.now_ns() + 1'000'000);
    }
  }
  // Also where it is unplugged.
  bus.unplug(0);
  CHECK(wait_until([&] {
    const std::int64_t before = heap_calls;
    const bool lost = device.read(bus.now_ns(), reading) == DeviceStatus::lost &&
                      device.write(press, bus.now_ns()) == DeviceStatus::lost;
    device.neutral();
    calls += heap_calls - before;
    return lost;
  }));
  CHECK(calls == 0);
  CHECK(wrong == 0);
}

}  // namespace
