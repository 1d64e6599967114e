#include "devices/hid/link/hid_rig.h"

#include <chrono>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "devices/device_error.h"
#include "devices/hid/link/fingertip_link.h"
#include "devices/hid/link/fingertip_search.h"
#include "devices/hid/link/hid_fingertip.h"
#include "devices/hid/link/streamed_tracker.h"
#include "devices/hid/our_devices.h"
#include "devices/rigs/fingertip_scene.h"
#include "protocols/input/input_error.h"
#include "protocols/input/sha256.h"
#include "protocols/rigs/rig_description.h"

namespace jnd {

namespace {

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
