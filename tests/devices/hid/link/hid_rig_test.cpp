// A whole rig over HID beside the simulated one.
#include "devices/hid/link/hid_rig.h"

#include "devices/device_error.h"
#include "devices/rigs/rig_factory.h"
#include "protocols/input/input_error.h"
#include "tests/catch.h"
#include "tests/devices/device_fixtures.h"
#include "tests/devices/hid/link/link_fixtures.h"
#include "tests/text_checks.h"

using namespace jnd;
using namespace jnd::testing;

namespace {

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

}  // namespace

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
