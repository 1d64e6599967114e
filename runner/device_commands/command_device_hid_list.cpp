// The real devices of jnd device list: everything on HID, those of ours first.
#include <algorithm>

#include <fmt/format.h>

#include "devices/device_error.h"
#include "devices/hid/report_words.h"
#include "devices/hid/udev_rule.h"
#include "runner/device_commands/command_device_hid.h"
#include "runner/device_commands/hid_devices.h"
#include "runner/terminal/terminal.h"
#include "runner/terminal/text_table.h"

namespace jnd {

namespace {

using Json = nlohmann::ordered_json;

Json entry_of(HidBus& bus, const HidInfo& info) {
  Json entry = {{"path", info.path},
                {"vendor", fmt::format("{:04X}", info.vendor)},
                {"product", fmt::format("{:04X}", info.product)},
                {"name", info.product_name},
                {"manufacturer", info.manufacturer},
                {"serial", info.serial},
                {"usage_page", info.usage_page},
                {"usage", info.usage},
                {"ours", is_ours(info) ? Json(is_tracker(info) ? "tracker" : "fingertip") : Json(nullptr)},
                {"transport", info.transport},
                {"usable", is_usable(info)}};
  if (!is_usable(info)) entry["udev_rule"] = udev_rule(info.vendor, info.product);
  if (!is_ours(info) || !is_usable(info)) return entry;
  try {
    with_device(bus, info, [&entry, &info](HidHandle& handle) {
      PageExchange pages(handle, info.serial, {}, {.read_ms = 150, .write_ms = 150, .tries = 2});
      const jnd_identity identity = pages.identity();
      entry["finger"] = finger_word(identity.finger);
      entry["firmware"] = firmware_text(identity);
      entry["calibration_id"] = calibration_id_of(identity);
    });
  } catch (const DeviceError& error) {
    entry["trouble"] = error.what();
  }
  return entry;
}

std::string what_it_is(const Json& device) {
  if (device["ours"].is_null())
    return fmt::format("usage {:04X}:{:02X}", device["usage_page"].get<int>(), device["usage"].get<int>());
  if (device["ours"] == "tracker") return "jnd tracker";
  return fmt::format("jnd fingertip device, finger: {}", device.value("finger", std::string("not asked")));
}

}  // namespace

Json hid_json(HidBus& bus) {
  std::vector<HidInfo> infos = bus.list();
  std::stable_sort(infos.begin(), infos.end(),
                   [](const HidInfo& a, const HidInfo& b) { return is_ours(a) && !is_ours(b); });
  Json devices = Json::array();
  for (const HidInfo& info : infos) devices.push_back(entry_of(bus, info));
  return devices;
}

std::string hid_text(const Json& devices) {
  if (devices.empty())
    return "  No HID device is connected, or none can be seen: a fingertip device would stand here with its serial "
           "number.\n";
  using Align = TextTable::Align;
  TextTable table({"path", "USB", "name", "serial", "what", "usable"},
                  {Align::left, Align::left, Align::left, Align::left, Align::left, Align::left});
  std::string rules, troubles;
  for (const Json& device : devices) {
    const auto text = [&device](const char* key) { return printable(device.value(key, std::string())); };
    const bool usable = device["usable"].get<bool>();
    const bool usb = device["transport"] == "USB";
    table.add({text("path"), usb ? text("vendor") + ":" + text("product") : text("transport"), text("name"),
               text("serial"), what_it_is(device), usable ? "yes" : "no"});
    if (device.contains("trouble")) troubles += fmt::format("  {}\n", warn(text("trouble")));
    const std::string rule = text("udev_rule");
    if (!usable && !device["ours"].is_null() && rules.find(rule) == std::string::npos) rules += rule + "\n";
  }
  std::string out = table.text() + troubles;
  if (rules.empty()) return out;
  const std::string shipped = shipped_udev_rules();
  out += fmt::format("\n  This login may not use a device of ours. Put into {}:\n\n{}\n", kUdevRulesPath, rules);
  if (!shipped.empty()) out += fmt::format("  or copy {} there, if it has the line.", printable(shipped));
  return out + "  Then run: sudo udevadm control --reload, and connect the device again.\n";
}

}  // namespace jnd
