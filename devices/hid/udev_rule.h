// What has to stand in a file of udev's so that a login may use a HID device.
#pragma once

#include <cstdint>
#include <string>

#include <fmt/format.h>

namespace jnd {

// Where such a file goes. Its name must sort below 73, or "uaccess" does nothing.
inline constexpr const char* kUdevRulesPath = "/etc/udev/rules.d/70-jnd.rules";

inline constexpr std::uint16_t kUsbBus = 0x0003;

// The line. It looks at the name of the HID device ("0003:1209:5AFE.0001"), which every bus and /dev/uhid have alike;
// ATTRS{idVendor} would find nothing on some.
inline std::string udev_rule(std::uint16_t vendor, std::uint16_t product, std::uint16_t bus = kUsbBus) {
  return fmt::format(
      "KERNEL==\"hidraw*\", SUBSYSTEM==\"hidraw\", KERNELS==\"{:04X}:{:04X}:{:04X}.*\", MODE=\"0660\", "
      "GROUP=\"plugdev\", TAG+=\"uaccess\"",
      bus, vendor, product);
}

}  // namespace jnd
