#include "devices/rig_factory.h"

#include <utility>
#include <vector>

#include <fmt/format.h>

#include "devices/fingertip_rig.h"
#include "devices/rrs3_device.h"
#include "devices/simulated_hand.h"
#include "protocols/input_error.h"

namespace jnd {

RigInfo simulated_rig_info(const Protocol& protocol, const DeviceSpec& spec) {
  return {.name = fmt::format("{} x {}", spec.name, protocol.rig.fingers.size()),
          .mode = "wrench",
          .tracker = protocol.rig.tracker,
          .simulated = true};
}

std::unique_ptr<Rig> make_simulated_rig(const Protocol& protocol, const DeviceSpec& spec,
                                        const ParticipantProfile& profile, int participant, std::uint64_t seed,
                                        Clock& clock) {
  const RigRequest& asked = protocol.rig;
  if (asked.device != spec.name)
    throw InputError(
        fmt::format("$.rig.device is \"{}\", but the device specification is of \"{}\": give the one of {}",
                    asked.device, spec.name, asked.device));
  if (asked.device != "rrs3")
    throw InputError(fmt::format("$.rig.device \"{}\" has no model to simulate: use \"rrs3\"", asked.device));
  if (asked.fingers.empty() || asked.fingers.size() > 2)
    throw InputError(fmt::format("$.rig.fingers names {} fingers: give one or two", asked.fingers.size()));
  if (asked.tracker != "hand")
    throw InputError(fmt::format("$.rig.tracker \"{}\" cannot be simulated: use \"hand\"", asked.tracker));

  std::vector<std::unique_ptr<FingertipDevice>> devices;
  for (std::size_t i = 0; i < asked.fingers.size(); ++i)
    devices.push_back(std::make_unique<Rrs3Device>(spec, profile.pulp_stiffness_n_per_m));

  const double expected = protocol.stimulus.expected_press_m;
  auto hand =
      std::make_unique<SimulatedHand>(HandHabits{.separation_m = asked.separation_m,
                                                 .sphere_radius_m = asked.sphere_radius_m,
                                                 .press_depth_m = expected > 0 ? expected : profile.press_depth_m,
                                                 .press_depth_sd_m = profile.press_depth_sd_m,
                                                 .closing_speed_m_per_s = profile.closing_speed_m_per_s,
                                                 .press_period_s = profile.press_period_s,
                                                 .lateral_sd_m = profile.lateral_sd_m},
                                      static_cast<int>(asked.fingers.size()), seed, participant);

  const Sphere sphere{.centre_m = Eigen::Vector3d::Zero(), .radius_m = asked.sphere_radius_m};
  return std::make_unique<FingertipRig>(simulated_rig_info(protocol, spec), std::move(devices), std::move(hand), clock,
                                        spec, sphere);
}

}  // namespace jnd
