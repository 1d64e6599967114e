// What the tests of links share.
#pragma once

#include <string>

#include "devices/fingertip_device.h"
#include "devices/hid/link/fingertip_link.h"
#include "protocols/rigs/device_description.h"
#include "tests/devices/hid/memory_bus.h"
#include "tests/wait_until.h"

namespace jnd::testing {

inline DeviceSpec shipped_rrs3() {
  return load_device_spec(std::string(JND_SOURCE_DIR) + "/devices/specs/rrs3.json");
}

inline LinkTarget target_of(const std::string& serial, const std::string& finger) {
  return {.serial = serial, .finger = finger, .spec = shipped_rrs3()};
}

// A contact of 500 N/m, 2 mm deep: 1 N.
inline jnd_command press_1n() {
  jnd_command command{};
  command.mode = JND_MODE_WRENCH;
  command.touching = true;
  command.normal[2] = JND_NORMAL_ONE;
  command.penetration_nm = 2'000'000;
  command.stiffness_mn_per_m = 500'000;
  command.most_force_un = 4'000'000;
  return command;
}

// The same as the loop gives it to a device; allowed up to 4 N.
inline DeviceCommand press_2mm() {
  DeviceCommand press;
  press.stiffness_n_per_m = 500;
  press.penetration_m = 0.002;
  press.force_n = 4;
  return press;
}

}  // namespace jnd::testing
