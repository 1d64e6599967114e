#include "devices/rigs/rig_factory.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "devices/mckibben/mckibben_device.h"
#include "devices/participants/simulated_hand.h"
#include "devices/rigs/fingertip_scene.h"
#include "devices/rigs/timed_rig.h"
#include "devices/rrs3/rrs3_device.h"
#include "devices/trackers/encoder_tracker.h"
#include "protocols/input/input_error.h"
#include "protocols/rigs/rig_description.h"

namespace jnd {

namespace {

const char* controller_name(const ForceGains& gains) {
  if (gains.kd > 0) return "PID";
  return gains.ki > 0 ? "PI" : "P";
}

void check(const RigRequest& asked, const RigSpec& spec) {
  if (asked.device != spec.name)
    throw InputError(fmt::format("$.rig.device is \"{}\", but the description is of \"{}\": give the one of {}",
                                 asked.device, spec.name, asked.device));
  const bool joint = spec.kinaesthetic() != nullptr;
  const std::size_t most = joint ? 1 : 2;
  if (asked.fingers.empty() || asked.fingers.size() > most)
    throw InputError(fmt::format("$.rig.fingers names {} fingers: the {} takes {}", asked.fingers.size(), spec.name,
                                 joint ? "one" : "one or two"));
  // Of fingers in space a simulated hand takes any tracker's place.
  if (asked.tracker != (joint ? "encoder" : "hand") && (joint || !is_streamed(asked.tracker)))
    throw InputError(fmt::format("$.rig.tracker \"{}\" cannot be simulated with the {}: use \"{}\"", asked.tracker,
                                 spec.name, joint ? "encoder" : "hand"));
}

void add(RigParts& parts, std::unique_ptr<FingertipDevice> device, const DeviceSpec& spec, int finger, Channel channel,
         double force_gain = 1) {
  parts.channels.push_back(
      {.device = device.get(), .spec = spec, .finger = finger, .channel = channel, .force_gain = force_gain});
  parts.devices.push_back(std::move(device));
}

std::unique_ptr<FingertipDevice> platform(const Protocol& protocol, const DeviceSpec& spec,
                                          const ParticipantProfile& profile, std::uint64_t seed) {
  Rrs3DeviceOptions options;
  options.pulp_stiffness_n_per_m = profile.pulp_stiffness_n_per_m;
  options.mode = protocol.rig.mode;
  options.sensor.noise_sd_n = spec.sensors.force_noise_sd_n;
  options.sensor.resolution_n = spec.sensors.force_resolution_n;
  options.seed = seed;
  return std::make_unique<Rrs3Device>(spec, options);
}

// One or two fingers around an object in space.
RigParts fingertip_parts(const Protocol& protocol, const RigDescription& rig, const ParticipantProfile& profile,
                         int participant, std::uint64_t seed) {
  RigParts parts;
  const DeviceSpec& spec = *rig.spec.cutaneous();
  const int fingers = static_cast<int>(protocol.rig.fingers.size());
  for (int finger = 0; finger < fingers; ++finger)
    add(parts, platform(protocol, spec, profile, seed + static_cast<std::uint64_t>(finger)), spec, finger,
        Channel::cutaneous);
  parts.scene = fingertip_scene(protocol, rig);
  parts.tracker = make_simulated_hand(protocol, rig, profile, participant, seed);
  return parts;
}

// One finger whose joint is driven, with or without a platform under its pulp.
RigParts joint_parts(const Protocol& protocol, const RigDescription& rig, const ParticipantProfile& profile,
                     int participant, std::uint64_t seed) {
  if (!rig.objects.empty())
    throw InputError(
        fmt::format("$.explore.objects lie between fingers, but the {} drives a joint: take a rig of "
                    "fingertip devices alone, such as rrs3",
                    rig.spec.name));
  const DeviceSpec& joint = *rig.spec.kinaesthetic();
  const bool in_metres = protocol.stimulus.unit == Unit::n_per_m;
  const double lever_m = rig.spec.lever_arm_m > 0 ? rig.spec.lever_arm_m : joint.lever_arm_m;
  const double per_rad = in_metres ? lever_m : 1;
  const double depth_rad = protocol.stimulus.expected_press / per_rad;
  // The torque of a contact, k L x, out of the device's own lever arm.
  const double force_gain = in_metres ? lever_m / joint.lever_arm_m : 1;
  // Persons differ from press to press by a fifth, as the hand does (1 mm of 5 mm).
  auto finger =
      std::make_unique<SimulatedFlexion>(FlexionHabits{.straight_rad = joint.lowest_travel,
                                                       .range_rad = joint.highest_travel - joint.lowest_travel,
                                                       .contact_flexion_rad = protocol.rig.contact_flexion_rad,
                                                       .press_depth_rad = depth_rad,
                                                       .press_depth_sd_rad = depth_rad / 5},
                                         seed, participant);
  auto device = std::make_unique<MckibbenDevice>(mckibben_options(joint, seed), *finger);
  RigParts parts;
  parts.scene.joint =
      JointObject{.contact_flexion_rad = protocol.rig.contact_flexion_rad, .penetration_per_rad = per_rad};
  if (const DeviceSpec* pulp = rig.spec.cutaneous())
    add(parts, platform(protocol, *pulp, profile, seed), *pulp, 0, Channel::cutaneous);
  parts.tracker = std::make_unique<EncoderTracker>(*device, *finger, joint.lowest_travel, lever_m);
  parts.motions.push_back(std::move(finger));
  add(parts, std::move(device), joint, 0, Channel::kinaesthetic, force_gain);
  return parts;
}

}  // namespace

RigInfo simulated_rig_info(const Protocol& protocol, const RigSpec& spec) {
  if (!protocol.rig.built_in()) return timed_rig_info(protocol.rig, true);
  std::string mode;
  if (spec.cutaneous() != nullptr) mode = to_string(protocol.rig.mode);
  if (const DeviceSpec* joint = spec.kinaesthetic())
    mode += (mode.empty() ? "" : " + ") + std::string(controller_name(joint->gains));
  return {.name = fmt::format("{} x {}", spec.name, protocol.rig.fingers.size()),
          .mode = std::move(mode),
          .tracker = is_streamed(protocol.rig.tracker) ? fmt::format("hand (for {})", protocol.rig.tracker)
                                                       : protocol.rig.tracker,
          .sha256 = spec.sha256,
          .simulated = true};
}

std::unique_ptr<Rig> make_simulated_rig(const Protocol& protocol, const RigDescription& rig,
                                        const ParticipantProfile& profile, int participant, std::uint64_t seed,
                                        Clock& clock, const RigOptions& options) {
  if (!protocol.rig.built_in()) return std::make_unique<TimedRig>(timed_rig_info(protocol.rig, true), clock);
  check(protocol.rig, rig.spec);
  RigParts parts = rig.spec.kinaesthetic() != nullptr ? joint_parts(protocol, rig, profile, participant, seed)
                                                      : fingertip_parts(protocol, rig, profile, participant, seed);
  return std::make_unique<FingertipRig>(simulated_rig_info(protocol, rig.spec), std::move(parts), clock, options);
}

std::size_t telemetry_ticks(const Protocol& protocol, const RigSpec& spec) noexcept {
  const Timeline& timeline = protocol.timeline;
  const double trial_s = timeline.explore_s + timeline.no_contact_time_out_s;
  const double seconds = 1 + (protocol.explore ? std::max(kLongestFreePiece_s, trial_s) : trial_s);
  const std::size_t devices = protocol.rig.fingers.size() * spec.devices.size();
  return static_cast<std::size_t>(std::ceil(seconds * 1000)) * devices;
}

}  // namespace jnd
