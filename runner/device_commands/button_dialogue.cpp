#include "runner/device_commands/button_dialogue.h"

#include <algorithm>
#include <array>
#include <memory>

#include <fmt/format.h>

#include "devices/clock.h"
#include "devices/device_error.h"

namespace jnd {

namespace {

constexpr int kRead_ms = 20;

// Of the usages of generic desktop controls; null for others.
const char* kind_of(const HidInfo& info) {
  if (info.usage_page != 0x01) return nullptr;
  switch (info.usage) {
    case 0x04:
      return "joystick";
    case 0x05:
      return "gamepad";
    case 0x06:
      return "keyboard";
    case 0x07:
      return "keypad";
    case 0x02:
      return "mouse";
    default:
      return nullptr;
  }
}

}  // namespace

std::vector<HidInfo> devices_with_buttons(HidBus& bus) {
  std::vector<HidInfo> devices;
  for (const HidInfo& info : bus.list()) {
    const auto same =
        std::find_if(devices.begin(), devices.end(), [&](const HidInfo& d) { return d.path == info.path; });
    if (same == devices.end())
      devices.push_back(info);
    else if (kind_of(*same) == nullptr && kind_of(info) != nullptr)
      *same = info;
  }
  return devices;
}

std::string described(const HidInfo& info) {
  const char* kind = kind_of(info);
  return fmt::format("{:04x}:{:04x} {}{}{}, {}{}{}, {}", info.vendor, info.product, info.manufacturer,
                     info.manufacturer.empty() ? "" : " ",
                     info.product_name.empty() ? "without a name" : info.product_name,
                     kind != nullptr ? kind : fmt::format("usage 0x{:02x}/0x{:02x}", info.usage_page, info.usage),
                     info.serial.empty() ? "" : ", serial ", info.serial, info.path);
}

std::optional<ButtonMapping> learn_buttons(HidBus& bus, const LearnerSetup& setup,
                                           const std::function<void(const std::string&)>& say,
                                           const std::function<bool()>& interrupted) {
  const std::unique_ptr<HidHandle> handle = bus.open(setup.info.path);
  const SteadyClock clock;
  ButtonLearner learner(setup, clock.now_ns());
  std::array<std::uint8_t, 4096> bytes{};
  std::string last;
  for (;;) {
    for (const std::string& line : learner.take_words()) say(last = line);
    if (learner.done()) return learner.mapping();
    if (learner.refused()) throw DeviceError(fmt::format("{}: {}", described(setup.info), last));
    if (interrupted()) return std::nullopt;
    const int count = handle->read(bytes, kRead_ms);
    const std::int64_t now_ns = clock.now_ns();
    if (interrupted()) return std::nullopt;  // a signal looks like a device that is gone
    if (count < 0)
      throw DeviceError(fmt::format("{} is no longer there ({}): plug it in and begin again", described(setup.info),
                                    handle->error()));
    if (count > 0)
      learner.report(std::span(bytes).first(static_cast<std::size_t>(count)), now_ns);
    else
      learner.look(now_ns);
  }
}

}  // namespace jnd
