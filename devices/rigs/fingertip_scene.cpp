#include "devices/rigs/fingertip_scene.h"

#include <algorithm>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "devices/participants/simulated_hand.h"
#include "protocols/input/input_error.h"

namespace jnd {

namespace {

// How far the object reaches to either side, where the fingers come from. place: in the protocol.
double farthest_surface_m(const VirtualObject& object, std::string_view place, const std::string& name) {
  double farthest = 0;
  for (const double side : {-1.0, 1.0}) {
    const double surface = object.surface_along(side * Eigen::Vector3d::UnitX());
    if (!(surface > 0))
      throw InputError(fmt::format("{} \"{}\" does not lie between two fingers: take another", place, name));
    farthest = std::max(farthest, surface);
  }
  return farthest;
}

double surface_of(const Protocol& protocol, const RigDescription& rig) {
  const RigRequest& asked = protocol.rig;
  return asked.object.empty() ? asked.sphere_radius_m : farthest_surface_m(rig.object, "$.rig.object", asked.object);
}

std::map<std::string, double> named_surfaces(const RigDescription& rig) {
  std::map<std::string, double> named;
  for (const auto& [name, object] : rig.objects) named[name] = farthest_surface_m(object, "$.explore.objects", name);
  return named;
}

}  // namespace

LoopScene fingertip_scene(const Protocol& protocol, const RigDescription& rig) {
  (void)surface_of(protocol, rig);
  (void)named_surfaces(rig);
  LoopScene scene;
  scene.object = protocol.rig.object.empty() ? sphere_object({.radius_m = protocol.rig.sphere_radius_m}) : rig.object;
  scene.named = rig.objects;
  return scene;
}

std::unique_ptr<Tracker> make_simulated_hand(const Protocol& protocol, const RigDescription& rig,
                                             const ParticipantProfile& profile, int participant, std::uint64_t seed) {
  const double expected = protocol.stimulus.expected_press;
  return std::make_unique<SimulatedHand>(HandHabits{.separation_m = protocol.rig.separation_m,
                                                    .sphere_radius_m = surface_of(protocol, rig),
                                                    .named_radius_m = named_surfaces(rig),
                                                    .press_depth_m = expected > 0 ? expected : profile.press_depth_m,
                                                    .press_depth_sd_m = profile.press_depth_sd_m,
                                                    .closing_speed_m_per_s = profile.closing_speed_m_per_s,
                                                    .press_period_s = profile.press_period_s,
                                                    .lateral_sd_m = profile.lateral_sd_m},
                                         static_cast<int>(protocol.rig.fingers.size()), seed, participant);
}

}  // namespace jnd
