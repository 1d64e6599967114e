// The link to one device: handshake, counts, clocks, what goes wrong on the wire.
#include "devices/hid/link/fingertip_link.h"

#include <atomic>

#include "devices/device_error.h"
#include "tests/catch.h"
#include "tests/devices/hid/link/link_fixtures.h"
#include "tests/text_checks.h"

using namespace jnd;
using namespace jnd::testing;

namespace {

struct Scene {
  explicit Scene(jnd_finger finger = JND_INDEX) : spec(shipped_rrs3()) {
    bus.add(jnd_fingertip_default_config("RRS3-0001", finger), spec);
  }
  DeviceSpec spec;
  MemoryBus bus;
};

// What the link says of a device that it does not take.
std::string refusal(MemoryBus& bus, const LinkTarget& target, const std::string& part) {
  const FingertipLink link(bus, target, bus);
  (void)wait_until([&] { return contains(link.missing(), part) || link.connection() > 0; });
  return link.connection() > 0 ? "taken" : link.missing();
}

}  // namespace

TEST_CASE("a device is found, asked and reported", "[link]") {
  Scene scene;
  FingertipLink link(scene.bus, target_of("RRS3-0001", "index"), scene.bus);
  REQUIRE(wait_until([&] { return link.connection() == 1; }));
  CHECK(link.missing().empty());
  const DeviceLinkReport report = link.report();
  CHECK(report.serial == "RRS3-0001");
  CHECK(report.finger == "index");
  CHECK(report.firmware == "1.0.0");
  CHECK(report.protocol_version == 1);
  CHECK(report.calibration_id.empty());
  CHECK(report.calibration_date.empty());
  CHECK_FALSE(report.is_model);
  CHECK(report.connected);
  CHECK(report.trouble.empty());
  CHECK(report.reconnections == 0);
  CHECK(report.received > 0);
  CHECK(report.missing == 0);
  CHECK(report.damaged == 0);
  CHECK(report.rejected == 0);
  CHECK(report.sent >= 20);
}

TEST_CASE("ten thousand commands come back, none missing", "[link]") {
  Scene scene;
  FingertipLink link(scene.bus, target_of("RRS3-0001", "index"), scene.bus);
  REQUIRE(wait_until([&] { return link.connection() == 1; }));
  HidFingertip device(link, RenderingMode::wrench);
  REQUIRE(device.engage(scene.bus.now_ns()) == DeviceStatus::ok);
  const DeviceCommand press = press_2mm();
  DeviceReading reading;
  int wrong = 0;
  double farthest_ms = 0;
  for (int tick = 0; tick < 10'000; ++tick) {
    const std::int64_t now_ns = scene.bus.now_ns();
    if (device.read(now_ns, reading) != DeviceStatus::ok) ++wrong;
    farthest_ms = std::max(farthest_ms, 1e-6 * std::abs(static_cast<double>(now_ns - reading.time_ns)));
    if (device.write(press, now_ns) != DeviceStatus::ok) ++wrong;
    scene.bus.sleep_until_ns(now_ns + 1'000'000);
  }
  CHECK(wrong == 0);
  CHECK(farthest_ms < 3);
  CHECK(reading.force_n == Approx(1.0).epsilon(0.01));
  device.neutral();
  // What is under way arrives.
  REQUIRE(wait_until([&] { return link.newest().telemetry.state == JND_STATE_REST; }));
  const DeviceLinkReport report = link.report();
  CHECK(report.missing == 0);
  CHECK(report.damaged == 0);
  CHECK(report.rejected == 0);
  CHECK(report.received >= 10'000);
  CHECK(report.sent + link.overwritten() >= 10'000);
  CHECK(report.sent >= 9'900);
  CHECK(report.clock_uncertainty_s < 0.001);
}

TEST_CASE("what is lost, damaged or repeated on the wire is counted exactly", "[link]") {
  Scene scene;
  // The numbering wraps around in the middle of it. Said before the link is there: to a link that has already read a
  // report, numbers that fall back are old ones.
  scene.bus.with(0, [](MemoryDevice& device) { device.firmware().sequence = 0xFFFFFE00U; });
  FingertipLink link(scene.bus, target_of("RRS3-0001", "index"), scene.bus);
  REQUIRE(wait_until([&] { return link.connection() == 1; }));
  std::int64_t lost = 0, damaged = 0, repeated = 0;
  for (const int count : {1, 2, 7, 40, 3, 1, 25}) {
    scene.bus.lose(0, count);
    lost += count;
    scene.bus.pass_ms(count + 5);
    scene.bus.damage(0, count);
    damaged += count;
    scene.bus.pass_ms(count + 5);
    scene.bus.repeat(0, count);
    repeated += count;
    scene.bus.pass_ms(count + 100);
  }
  CHECK(scene.bus.with(0, [](const MemoryDevice& device) { return device.firmware().sequence; }) < 10'000);
  const DeviceLinkReport report = link.report();
  CHECK(report.missing == lost + damaged);  // a damaged report has no number that could be believed
  CHECK(report.damaged == damaged + repeated);
  CHECK(report.connected);
}

TEST_CASE("an old report is never shown", "[link]") {
  Scene scene;
  FingertipLink link(scene.bus, target_of("RRS3-0001", "index"), scene.bus);
  REQUIRE(wait_until([&] { return link.connection() == 1; }));
  std::uint32_t last = 0;
  for (int i = 0; i < 200; ++i) {
    if (i % 20 == 0) scene.bus.repeat(0, 3);
    // Numbers that fall back by ten, as of reports that overtook each other.
    if (i % 50 == 49) scene.bus.with(0, [](MemoryDevice& device) { device.firmware().sequence -= 10; });
    scene.bus.pass_ms(1);
    const std::uint32_t shown = link.newest().telemetry.sequence;
    CHECK(static_cast<std::int32_t>(shown - last) >= 0);
    last = shown;
  }
  CHECK(link.report().damaged >= 4 * 10);
}

TEST_CASE("a fast or slow clock of the device is followed", "[link]") {
  Scene scene;
  scene.bus.set_drift(0, 90);
  FingertipLink link(scene.bus, target_of("RRS3-0001", "index"), scene.bus);
  REQUIRE(wait_until([&] { return link.connection() == 1; }));
  double farthest_ms = 0;
  for (int ms = 0; ms < 20'000; ++ms) {
    if (ms % 10 == 0) link.send(jnd_command{});
    scene.bus.pass_ms(1);
    farthest_ms =
        std::max(farthest_ms, 1e-6 * std::abs(static_cast<double>(scene.bus.now_ns() - link.newest().time_ns)));
  }
  CHECK(farthest_ms < 5);
  CHECK(link.report().clock_drift_ppm == Approx(90).margin(10));
  CHECK(link.clock_steps() == 0);
}

TEST_CASE("a model in software is told from a device by its own word", "[link]") {
  Scene scene;
  scene.bus.with(0, [](MemoryDevice& device) {
    device.config.identity.capabilities |= JND_IS_MODEL;
    device.power_up();
  });
  FingertipLink link(scene.bus, target_of("RRS3-0001", "index"), scene.bus);
  REQUIRE(wait_until([&] { return link.connection() == 1; }));
  CHECK(link.report().is_model);
}

TEST_CASE("a device that may do less is refused with the numbers, one that may do more is taken", "[link]") {
  const auto said = [](auto change, const std::string& part) {
    Scene scene;
    scene.bus.with(0, [&](MemoryDevice& device) {
      change(device.config);
      device.power_up();
    });
    return refusal(scene.bus, target_of("RRS3-0001", "index"), part);
  };
  CHECK(contains(said([](jnd_fingertip_config& config) { config.limits.most_force_un = 3'000'000; }, "force up"),
                 "force up to 3 N, needed 4.7"));
  CHECK(
      contains(said([](jnd_fingertip_config& config) { config.limits.most_stiffness_mn_per_m = 900'000; }, "stiffness"),
               "stiffness up to 900 N/m, needed 2000"));
  CHECK(contains(said([](jnd_fingertip_config& config) { config.limits.most_roll_dmrad = 1000; }, "roll"),
                 "roll up to 0.1 rad"));
  CHECK(contains(said([](jnd_fingertip_config& config) { config.limits.most_vibration_mg = 500; }, "vibration"),
                 "vibration up to 0.5 g, needed 1"));
  CHECK(contains(said([](jnd_fingertip_config& config) { config.limits.highest_height_nm = -18'000'000; }, "height"),
                 "height up to -0.018 m"));
  CHECK(said([](jnd_fingertip_config& config) { config.limits.most_force_un = 9'000'000; }, "?") == "taken");
}

TEST_CASE("another device, another finger, another version: refused by name", "[link]") {
  {
    Scene scene(JND_THUMB);
    CHECK(contains(refusal(scene.bus, target_of("RRS3-0001", "index"), "thumb"), "made for the thumb finger"));
  }
  {
    Scene scene(JND_FINGER_ANY);
    CHECK(refusal(scene.bus, target_of("RRS3-0001", "index"), "?") == "taken");
  }
  {
    Scene scene;
    scene.bus.with(0, [](MemoryDevice& device) {
      device.config.identity.lowest_version = 2;
      device.config.identity.highest_version = 4;
      device.power_up();
    });
    const std::string said = refusal(scene.bus, target_of("RRS3-0001", "index"), "versions");
    CHECK(contains(said, "versions 2 to 4"));
    CHECK(contains(said, "versions 1 to 1"));
  }
  {
    Scene scene;
    const FingertipLink link(scene.bus, target_of("RRS3-0002", "index"), scene.bus);
    REQUIRE(wait_until([&] { return contains(link.missing(), "RRS3-0002"); }));
    scene.bus.wait_ms(300);
    CHECK(link.connection() == 0);
    CHECK(contains(link.missing(), "RRS3-0002"));
  }
  {
    Scene scene;
    scene.bus.refuse_opening(true);
    CHECK(contains(refusal(scene.bus, target_of("RRS3-0001", "index"), "login"), "this login may not use"));
  }
}

TEST_CASE("unplugged at any moment: said at once, and gone on when it is back", "[link]") {
  Scene scene;
  FingertipLink link(scene.bus, target_of("RRS3-0001", "index"), scene.bus);
  REQUIRE(wait_until([&] { return link.connection() == 1; }));
  HidFingertip device(link, RenderingMode::wrench);
  std::uint32_t random = 12345;
  for (int round = 1; round <= 15; ++round) {
    REQUIRE(device.engage(scene.bus.now_ns()) == DeviceStatus::ok);
    DeviceCommand press;
    press.stiffness_n_per_m = 500;
    press.penetration_m = 0.002;
    press.force_n = 4;
    random = random * 1664525U + 1013904223U;
    const int ticks = static_cast<int>(random >> 26U);
    DeviceReading reading;
    for (int tick = 0; tick < ticks; ++tick) {
      CHECK(device.read(scene.bus.now_ns(), reading) == DeviceStatus::ok);
      (void)device.write(press, scene.bus.now_ns());
      scene.bus.sleep_until_ns(scene.bus.now_ns() + 1'000'000);
    }
    scene.bus.unplug(0);
    CHECK(wait_until([&] { return device.read(scene.bus.now_ns(), reading) == DeviceStatus::lost; }));
    CHECK(device.write(press, scene.bus.now_ns()) == DeviceStatus::lost);
    CHECK(contains(link.missing(), "RRS3-0001"));
    CHECK_FALSE(link.report().connected);
    if (random % 2 == 0) scene.bus.wait_ms(static_cast<int>(random % 50));
    scene.bus.plug(0);
    REQUIRE(wait_until([&] { return link.connection() == static_cast<std::uint32_t>(round) + 1; }));
    // The engagement before is over: nothing of it reaches the device that came back.
    CHECK(device.read(scene.bus.now_ns(), reading) == DeviceStatus::lost);
    CHECK(device.write(press, scene.bus.now_ns()) == DeviceStatus::lost);
    CHECK(scene.bus.with(0, [](const MemoryDevice& one) { return one.firmware().state; }) == JND_STATE_REST);
    CHECK(link.report().reconnections == round);
  }
  CHECK(link.report().missing == 0);
  CHECK(link.report().damaged == 0);
}

TEST_CASE("a write that blocks stops neither the readings nor the loop, and the watchdog stops the force", "[link]") {
  Scene scene;
  FingertipLink link(scene.bus, target_of("RRS3-0001", "index"), scene.bus);
  REQUIRE(wait_until([&] { return link.connection() == 1; }));
  HidFingertip device(link, RenderingMode::wrench);
  REQUIRE(device.engage(scene.bus.now_ns()) == DeviceStatus::ok);
  const DeviceCommand press = press_2mm();
  DeviceReading reading;
  const auto tick = [&] {
    const DeviceStatus status = device.read(scene.bus.now_ns(), reading);
    (void)device.write(press, scene.bus.now_ns());
    scene.bus.sleep_until_ns(scene.bus.now_ns() + 1'000'000);
    return status;
  };
  for (int ms = 0; ms < 400; ++ms) REQUIRE(tick() == DeviceStatus::ok);
  CHECK(reading.force_n == Approx(1.0).epsilon(0.02));
  const std::int64_t received_before = link.report().received;
  scene.bus.block_writes(0, true);
  int stopped_after = 0;
  for (int ms = 1; ms <= 500; ++ms)
    if (tick() == DeviceStatus::stopped && stopped_after == 0) stopped_after = ms;
  CHECK(stopped_after >= 15);
  CHECK(stopped_after <= 40);  // ms of the bus's own time: 20 of the watchdog, and the way
  CHECK(link.report().received >= received_before + 490);
  CHECK(std::abs(scene.bus.with(0, [](const MemoryDevice& one) { return one.force_n(); })) < 0.01);
  CHECK(contains(link.report().trouble, "watchdog"));
  // It is taken up again by the next presentation.
  scene.bus.block_writes(0, false);
  REQUIRE(wait_until([&] { return device.engage(scene.bus.now_ns()) == DeviceStatus::ok; }));
  bool went_on = true;
  for (int ms = 0; ms < 400; ++ms) went_on = went_on && tick() == DeviceStatus::ok;
  CHECK(link.overwritten() > 400);
  CHECK(went_on);
  CHECK(reading.force_n == Approx(1.0).epsilon(0.02));
}

TEST_CASE("a stop of the device itself is told, and one that stays is told again", "[link]") {
  Scene scene;
  FingertipLink link(scene.bus, target_of("RRS3-0001", "index"), scene.bus);
  REQUIRE(wait_until([&] { return link.connection() == 1; }));
  HidFingertip device(link, RenderingMode::wrench);
  const DeviceCommand press = press_2mm();
  const auto first_stop_ms = [&](int longest_ms) {
    REQUIRE(device.engage(scene.bus.now_ns()) == DeviceStatus::ok);
    DeviceReading reading;
    for (int ms = 0; ms < longest_ms; ++ms) {
      if (device.read(scene.bus.now_ns(), reading) == DeviceStatus::stopped) return ms;
      (void)device.write(press, scene.bus.now_ns());
      scene.bus.sleep_until_ns(scene.bus.now_ns() + 1'000'000);
      if (ms == 50) scene.bus.with(0, [](MemoryDevice& one) { one.stop_button = true; });
    }
    return longest_ms;
  };
  const int first = first_stop_ms(200);
  CHECK(first >= 50);
  CHECK(first <= 60);
  CHECK(contains(link.report().trouble, "stop button"));
  device.neutral();
  scene.bus.pass_ms(20);
  CHECK(first_stop_ms(300) < 150);  // the button is still pressed
  CHECK(contains(link.missing(), "stop button"));
  device.neutral();
  scene.bus.with(0, [](MemoryDevice& one) { one.stop_button = false; });
  scene.bus.pass_ms(20);
  device.neutral();
  CHECK(wait_until([&] { return link.missing().empty(); }));
  CHECK(first_stop_ms(40) == 40);  // mode rest made it forget
}

TEST_CASE("at its end a link leaves the device at rest", "[link]") {
  Scene scene;
  {
    FingertipLink link(scene.bus, target_of("RRS3-0001", "index"), scene.bus);
    REQUIRE(wait_until([&] { return link.connection() == 1; }));
    (void)link.engage();
    REQUIRE(wait_until([&] {
      link.send(press_1n());
      return link.newest().telemetry.state == JND_STATE_ACTIVE;
    }));
  }
  CHECK(scene.bus.with(0, [](const MemoryDevice& one) { return one.firmware().state; }) == JND_STATE_REST);
}

TEST_CASE("links come and go while a device does", "[link]") {
  Scene scene;
  std::atomic<bool> over{false};
  std::thread hand([&] {
    while (!over.load()) {
      scene.bus.unplug(0);
      scene.bus.wait_ms(7);
      scene.bus.plug(0);
      scene.bus.wait_ms(23);
    }
  });
  int done = 0;
  for (; done < 40; ++done) {
    FingertipLink link(scene.bus, target_of("RRS3-0001", "index"), scene.bus);
    for (int tick = 0; tick < done; ++tick) {
      link.send(press_1n());
      scene.bus.wait_ms(1);
    }
  }
  CHECK(done == 40);  // none of them hangs
  over.store(true);
  hand.join();
}
