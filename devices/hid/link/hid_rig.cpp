#include "devices/hid/link/hid_rig.h"

#include <algorithm>
#include <string>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "devices/device_error.h"
#include "devices/hid/firmware/jnd_report.h"
#include "devices/hid/hidapi_bus.h"
#include "devices/hid/link/fingertip_link.h"
#include "devices/hid/link/hid_tracker.h"
#include "devices/hid/our_devices.h"
#include "devices/hid/page_exchange.h"
#include "devices/hid/report_words.h"
#include "devices/rigs/fingertip_scene.h"
#include "protocols/input/input_error.h"
#include "protocols/input/sha256.h"
#include "protocols/rigs/rig_description.h"

namespace jnd {

namespace {

// Which of our fingertip devices are connected, and which of them a protocol's fingers wear.
struct FoundFingertip {
  std::string path;
  std::string serial;   // empty: it could not be asked
  std::string finger;   // that it is made for; "any"
  std::string trouble;  // why it could not be asked
};

// Asks every one; waits for answers, so never in the loop. A device that another link uses may be asked meanwhile.
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

// "RRS3-0001 (thumb), /dev/hidraw3: ..."; "none of ours" for none.
std::string text_of(const std::vector<FoundFingertip>& found) {
  std::string text;
  for (const FoundFingertip& one : found) {
    if (!text.empty()) text += ", ";
    text += one.trouble.empty() ? fmt::format("{} ({})", one.serial, one.finger) : one.trouble;
  }
  return text.empty() ? "none of ours" : text;
}

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

// The serial of each finger's device, by the rig file or, where that leaves it open, the only one made for the finger;
// empty: it is not there. Throws InputError where the rig file names other fingers than the protocol, DeviceError where
// several would fit.
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

constexpr std::chrono::milliseconds kLookEvery{100};
constexpr std::chrono::milliseconds kReadyEvery{10};

using Steady = std::chrono::steady_clock;

void check(const RigRequest& asked, const RigSpec& spec) {
  if (asked.device != spec.name)
    throw InputError(fmt::format("$.rig.device is \"{}\", but the description is of \"{}\": give the one of {}",
                                 asked.device, spec.name, asked.device));
  if (spec.kinaesthetic() != nullptr || spec.cutaneous() == nullptr)
    throw InputError(
        fmt::format("$.rig.device \"{}\" has a joint, and no such device is connected by USB HID: use "
                    "\"rrs3\", or --rig simulated",
                    asked.device));
  if (asked.fingers.empty() || asked.fingers.size() > 2)
    throw InputError(
        fmt::format("$.rig.fingers names {} fingers: the {} takes one or two", asked.fingers.size(), spec.name));
}

// What to do, after why a device that is a program is not there.
std::string hint(const HidBus& bus) {
  const std::string absent = bus.absent();
  return (absent.empty() ? "" : absent + "; ") +
         "connect it and switch it on; \"jnd device list\" shows what is there, \"jnd doctor\" whether this login may "
         "use it (the udev rule devices/hid/70-jnd.rules)";
}

// Which device each finger wears; waits until there is one for each.
std::vector<std::string> await_serials(const std::vector<std::string>& fingers, const RigFile& file, HidBus& bus,
                                       Steady::time_point deadline) {
  for (;;) {
    const std::vector<FoundFingertip> found = find_fingertips(bus);
    std::vector<std::string> serials = serials_for(fingers, file, found);
    std::vector<std::string> open;
    for (std::size_t i = 0; i < fingers.size(); ++i)
      if (serials[i].empty()) open.push_back(fingers[i]);
    if (open.empty()) return serials;
    if (Steady::now() >= deadline)
      throw DeviceError(fmt::format("no device for the {} finger is connected (connected: {}): {}",
                                    fmt::join(open, " and the "), text_of(found), hint(bus)));
    std::this_thread::sleep_for(kLookEvery);
  }
}

// Whether all are there. A hand that the tracker does not see just now, or a fault, is seen to before a presentation.
bool connected(const RigConnections& rig) {
  for (const DeviceLinkReport& device : rig.devices)
    if (!device.connected) return false;
  return !rig.tracker || rig.tracker->connected;
}

std::unique_ptr<Tracker> make_tracker(const Protocol& protocol, const RigDescription& rig, const RigFile& file,
                                      const ParticipantProfile& profile, int participant, std::uint64_t seed,
                                      const Clock& clock, HidBus& bus) {
  const RigRequest& asked = protocol.rig;
  if (is_streamed(asked.tracker)) return make_streamed_tracker(asked.tracker, asked.fingers, file.tracker, bus, clock);
  if (asked.tracker != "hand")
    throw InputError(
        fmt::format("$.rig.tracker \"{}\" does not tell where fingers in space are: use \"hand\", \"hid\", "
                    "\"process\" or \"replay\"",
                    asked.tracker));
  return make_simulated_hand(protocol, rig, profile, participant, seed);
}

}  // namespace

std::vector<SocketDevice> socket_devices(const RigFile& file, bool started) {
  std::vector<SocketDevice> devices;
  for (const WornDevice& worn : file.devices)
    if (!worn.socket.empty() || (started && !worn.command.empty()))
      devices.push_back({.path = worn.path(), .socket = worn.socket, .command = worn.command, .folder = file.folder});
  if (!file.tracker.socket.empty())
    devices.push_back({.path = file.tracker.socket.string(), .socket = file.tracker.socket});
  return devices;
}

std::unique_ptr<HidBus> make_bus(std::vector<SocketDevice> devices) {
  auto usb = std::make_unique<HidapiBus>();
  if (devices.empty()) return usb;
  return std::make_unique<JoinedBus>(std::make_unique<SocketBus>(std::move(devices)), std::move(usb));
}

RigInfo hid_rig_info(const Protocol& protocol, const RigSpec& spec) {
  const std::string& tracker = protocol.rig.tracker;
  return {.name = fmt::format("{} (HID) x {}", spec.name, protocol.rig.fingers.size()),
          .mode = std::string(to_string(protocol.rig.mode)),
          .tracker = tracker,
          // Another than the simulated rig's of the same description: a session is not begun on one and ended on the
          // other.
          .sha256 = sha256_hex("hid " + spec.sha256),
          .simulated = tracker != "hid" && tracker != "process"};
}

std::unique_ptr<Rig> make_hid_rig(const Protocol& protocol, const RigDescription& rig, const RigFile& file,
                                  const ParticipantProfile& profile, int participant, std::uint64_t seed, Clock& clock,
                                  HidBus& bus, const RigOptions& options, std::chrono::milliseconds longest_wait) {
  check(protocol.rig, rig.spec);
  const Steady::time_point deadline = Steady::now() + longest_wait;
  const DeviceSpec& spec = *rig.spec.cutaneous();
  const std::vector<std::string>& fingers = protocol.rig.fingers;
  RigParts parts;
  parts.scene = fingertip_scene(protocol, rig);
  parts.tracker = make_tracker(protocol, rig, file, profile, participant, seed, clock, bus);
  const std::vector<std::string> serials = await_serials(fingers, file, bus, deadline);
  if (options.realtime) parts.thread = std::make_unique<RenderThread>(*options.realtime);
  // Below the loop, above everything else: nothing reaches the loop without them.
  const int priority = options.realtime && *options.realtime != RealtimePolicy::off ? kRealtimePriority - 1 : 0;
  for (std::size_t i = 0; i < fingers.size(); ++i) {
    auto link = std::make_unique<FingertipLink>(
        bus,
        LinkTarget{
            .serial = serials[i], .finger = fingers[i], .spec = spec, .damps = protocol.stimulus.damping_n_s_per_m > 0},
        clock, priority);
    auto device = std::make_unique<HidFingertip>(*link, protocol.rig.mode);
    parts.channels.push_back(
        {.device = device.get(), .spec = spec, .finger = static_cast<int>(i), .channel = Channel::cutaneous});
    parts.devices.push_back(std::move(device));
    parts.links.push_back(std::move(link));
  }
  auto made = std::make_unique<FingertipRig>(hid_rig_info(protocol, rig.spec), std::move(parts), clock, options);
  while (!connected(made->connections())) {
    if (Steady::now() >= deadline) {
      std::string serials_there;
      for (const HidInfo& info : bus.list())
        if (is_ours(info)) serials_there += (serials_there.empty() ? "" : ", ") + name_of(info);
      throw DeviceError(fmt::format("{} (connected: {}): {}", made->missing(),
                                    serials_there.empty() ? "none of ours" : serials_there, hint(bus)));
    }
    std::this_thread::sleep_for(kReadyEvery);
  }
  return made;
}

}  // namespace jnd
