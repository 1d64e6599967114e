#include "devices/hid/virtual/virtual_buttons.h"

#include <array>
#include <utility>

#include <fmt/format.h>

#include "devices/hid/virtual/virtual_device.h"

namespace jnd {

namespace {
constexpr std::uint8_t kCentre = 0x80;  // of the stick, which is never moved
}

VirtualButtons::VirtualButtons(std::string serial, InputReport port)
    : serial_(std::move(serial)), port_(std::move(port)) {}

HidDescription VirtualButtons::description() const {
  return {.name = "button box (virtual)",
          .phys = "virtual/" + serial_,
          .serial = serial_,
          .vendor = kVirtualVendor,
          .product = kVirtualButtonsProduct,
          .report_descriptor = gamepad_descriptor()};
}

void VirtualButtons::step(std::int64_t /*timer_ns*/, bool frozen) {
  if (frozen || told_ == buttons_) return;
  told_ = buttons_;
  if (port_(std::array<std::uint8_t, 3>{kCentre, kCentre, buttons_})) ++sent_;
}

bool VirtualButtons::obey(const DeviceOrder& order) {
  if (order.kind != OrderKind::button) return false;
  const auto bit = static_cast<std::uint8_t>(1U << static_cast<unsigned>(order.button - 1));
  buttons_ = static_cast<std::uint8_t>(order.on ? buttons_ | bit : buttons_ & ~bit);
  return true;
}

std::string VirtualButtons::status() const {
  return fmt::format("\"kind\":\"buttons\",\"serial\":{},\"buttons\":{},\"sent\":{}", json_text(serial_), buttons_,
                     sent_);
}

}  // namespace jnd
