// What the tests of this room share: the shipped device and profile, a protocol's rig, and a rig of chosen parts.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "devices/participants/simulated_hand.h"
#include "devices/rigs/fingertip_rig.h"
#include "devices/rigs/rig_factory.h"
#include "devices/rrs3/rrs3_device.h"
#include "protocols/rigs/device_description.h"
#include "protocols/rigs/rig_description.h"

namespace jnd::testing {

inline std::filesystem::path source_path(const char* relative) {
  return std::filesystem::path(JND_SOURCE_DIR) / relative;
}
inline DeviceSpec rrs3_spec() {
  return load_device_spec(source_path("devices/specs/rrs3.json"));
}
inline RigDescription rrs3_rig() {
  return {.spec = load_rig_spec(source_path("devices/specs/rrs3.json"))};
}
inline RigDescription shipped_rig(const char* name) {
  return {.spec = load_rig_spec(source_path("devices/specs") / (std::string(name) + ".json"))};
}
inline ParticipantProfile shipped_profile(const char* name) {
  return load_profile(source_path("devices/profiles") / (std::string(name) + ".json"));
}

// The parts of a protocol that devices read: those of the published experiment.
inline Protocol small_protocol() {
  Protocol protocol;
  protocol.stimulus.reference = 900;
  protocol.rig = {.device = "rrs3", .fingers = {"thumb", "index"}, .tracker = "hand"};
  protocol.conditions = {{.name = "S", .label = "force", .cues = {.force = true, .vibration = false}},
                         {.name = "V", .label = "vibration", .cues = {.force = false, .vibration = true}},
                         {.name = "SV", .label = "both", .cues = {.force = true, .vibration = true}}};
  return protocol;
}

inline constexpr Cues kForce{.force = true, .vibration = false};
inline constexpr Cues kVibration{.force = false, .vibration = true};
inline constexpr Cues kBoth{.force = true, .vibration = true};

// Devices around the sphere of 40 mm, one a finger.
inline LoopScene sphere_scene(double radius_m = 0.040) {
  return {.object = sphere_object({.radius_m = radius_m})};
}
inline std::vector<LoopDevice> on_fingers(const std::vector<FingertipDevice*>& devices, const DeviceSpec& spec) {
  std::vector<LoopDevice> channels;
  for (std::size_t i = 0; i < devices.size(); ++i)
    channels.push_back({.device = devices[i], .spec = spec, .finger = static_cast<int>(i)});
  return channels;
}

inline PresentRequest request(double stiffness, Cues cues, IntervalId id = {.trial = 1}) {
  return {.stimulus = {.stiffness = stiffness, .cues = cues}, .explore_s = 3, .no_contact_time_out_s = 10, .id = id};
}

}  // namespace jnd::testing
