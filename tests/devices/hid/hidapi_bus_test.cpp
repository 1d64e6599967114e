// What can be said of hidapi without a device: tests/kernel has the rest.
#include "devices/hid/hidapi_bus.h"

#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include "devices/device_error.h"
#include "tests/catch.h"

using namespace jnd;

TEST_CASE("a path that is not there is an error that names it", "[hidapi_bus]") {
  HidapiBus bus;
  // Many times: what hidapi does with a file that is no HID device may go well by chance.
  for (int round = 0; round < 20; ++round)
    for (const char* path : {"/dev/no-such-hidraw", "/dev/null", ""}) {
      CAPTURE(path);
      try {
        (void)bus.open(path);
        FAIL("it was opened");
      } catch (const DeviceError& error) {
        CHECK(std::string(error.what()).find(path) != std::string::npos);
      }
    }
}

TEST_CASE("many threads may list and open at once", "[hidapi_bus]") {
  std::vector<std::thread> threads;
  std::atomic<int> refused{0};
  for (int i = 0; i < 4; ++i)
    threads.emplace_back([&refused] {
      HidapiBus bus;
      for (int round = 0; round < 20; ++round) {
        (void)bus.list();
        try {
          (void)bus.open("/dev/no-such-hidraw");
        } catch (const DeviceError&) {
          ++refused;
        }
      }
    });
  for (std::thread& thread : threads) thread.join();
  CHECK(refused.load() == 80);
}
