#include "devices/hid/link/fingertip_search.h"

#include <algorithm>

#include <fmt/format.h>

#include "devices/device_error.h"
#include "devices/hid/firmware/jnd_report.h"
#include "devices/hid/our_devices.h"
#include "devices/hid/page_exchange.h"
#include "devices/hid/report_words.h"
#include "protocols/input/input_error.h"

namespace jnd {

std::vector<FoundFingertip> find_fingertips(HidBus& bus) {
  std::vector<FoundFingertip> found;
  for (const HidInfo& info : bus.list()) {
    if (!is_fingertip(info)) continue;
    FoundFingertip one;
    one.path = info.path;
    try {
      const std::unique_ptr<HidHandle> handle = bus.open(info.path);
      const jnd_identity identity = PageExchange(*handle, info.path).identity();
      one.serial = serial_of(identity);
      one.finger = finger_word(identity.finger);
    } catch (const DeviceError& error) {
      one.trouble = error.what();
    }
    found.push_back(std::move(one));
  }
  return found;
}

std::string text_of(const std::vector<FoundFingertip>& found) {
  std::string text;
  for (const FoundFingertip& one : found) {
    if (!text.empty()) text += ", ";
    text += one.trouble.empty() ? fmt::format("{} ({})", one.serial, one.finger) : one.trouble;
  }
  return text.empty() ? "none of ours" : text;
}

namespace {

// Of the device that is the program at that place; empty: it is not there.
std::string serial_at(const std::string& path, const std::vector<FoundFingertip>& found) {
  for (const FoundFingertip& one : found)
    if (one.path == path) return one.serial;
  return {};
}

// Of a finger whose device the rig file leaves open.
std::string only_one_for(const std::string& finger, bool only_finger, const std::vector<FoundFingertip>& found) {
  std::vector<std::string> fitting;
  const auto take = [&](const std::string& made_for) {
    for (const FoundFingertip& one : found)
      if (one.trouble.empty() && one.finger == made_for) fitting.push_back(one.serial);
  };
  take(finger);
  if (fitting.empty() && only_finger) take(std::string(finger_word(JND_FINGER_ANY)));
  if (fitting.size() > 1)
    throw DeviceError(
        fmt::format("devices {} and {} both fit the {} finger: name the one that is worn in a rig file (\"devices\"), "
                    "or disconnect the other",
                    fitting[0], fitting[1], finger));
  return fitting.empty() ? std::string() : fitting.front();
}

}  // namespace

std::vector<std::string> serials_for(const std::vector<std::string>& fingers, const RigFile& rig,
                                     const std::vector<FoundFingertip>& found) {
  std::vector<std::string> serials;
  for (const std::string& finger : fingers) {
    const auto worn = std::find_if(rig.devices.begin(), rig.devices.end(),
                                   [&](const WornDevice& device) { return device.finger == finger; });
    if (worn == rig.devices.end() && !rig.devices.empty())
      throw InputError(
          fmt::format("the rig file names no device for the {} finger, which $.rig.fingers of the protocol asks for: "
                      "add one to its \"devices\"",
                      finger));
    if (worn != rig.devices.end() && !worn->serial.empty())
      serials.push_back(worn->serial);
    else if (worn != rig.devices.end() && !worn->path().empty())
      serials.push_back(serial_at(worn->path(), found));
    else
      serials.push_back(only_one_for(finger, fingers.size() == 1, found));
  }
  return serials;
}

}  // namespace jnd
