// What the control loop calls of a device over HID neither allocates nor frees: counted at malloc itself.
#include <cstdint>
#include <cstdlib>

#include "devices/hid/link/fingertip_link.h"
#include "tests/catch.h"
#include "tests/counted_heap.h"
#include "tests/devices/hid/link/link_fixtures.h"

using namespace jnd;
using namespace jnd::testing;

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
