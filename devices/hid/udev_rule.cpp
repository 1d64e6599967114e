#include "devices/hid/udev_rule.h"

#include <fmt/format.h>

namespace jnd {

std::string udev_rule(std::uint16_t vendor, std::uint16_t product, std::uint16_t bus) {
  return fmt::format(
      "KERNEL==\"hidraw*\", SUBSYSTEM==\"hidraw\", KERNELS==\"{:04X}:{:04X}:{:04X}.*\", MODE=\"0660\", "
      "GROUP=\"plugdev\", TAG+=\"uaccess\"",
      bus, vendor, product);
}

}  // namespace jnd
