#include "devices/participants/simulated_flexion.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "devices/rig.h"
#include "protocols/input/input_error.h"
#include "protocols/random_stream.h"

namespace jnd {

SimulatedFlexion::SimulatedFlexion(const FlexionHabits& habits, std::uint64_t seed, int participant)
    : habits_(habits), seed_(seed), participant_(participant) {
  for (const double habit : {habits.range_rad, habits.contact_flexion_rad, habits.press_depth_rad,
                             habits.closing_speed_rad_per_s, habits.press_period_s})
    if (!(habit > 0))
      throw InputError(
          std::string("a simulated finger needs a positive range, way to the object, depth, speed and press period: "
                      "look at $.rig.contact_flexion_rad and the expected press in $.stimulus"));
  if (habits.contact_flexion_rad >= habits.range_rad)
    throw InputError(
        fmt::format("$.rig.contact_flexion_rad is {} rad, but the finger flexes by {:.3f} rad only: it "
                    "would never meet the object",
                    habits.contact_flexion_rad, habits.range_rad));
  motion_ = PressMotion(habits.contact_flexion_rad, habits.closing_speed_rad_per_s, habits.press_period_s);
}

void SimulatedFlexion::begin(const PresentRequest& request, std::int64_t start_ns) {
  start_ns_ = start_ns;
  RandomStream random(seed_, static_cast<std::uint64_t>(participant_), "flexion", interval_part(request.id, 0));
  std::vector<double> depths(motion_.presses_in(std::max(request.explore_s, request.no_contact_time_out_s)));
  for (double& depth : depths) {
    do {
      depth = habits_.press_depth_rad + habits_.press_depth_sd_rad * random.normal();
    } while (depth <= habits_.press_depth_rad / 10);
  }
  motion_.set_depths(std::move(depths));
}

double SimulatedFlexion::angle_rad(std::int64_t time_ns) const noexcept {
  const double depth = motion_.depth(1e-9 * static_cast<double>(time_ns - start_ns_));
  return habits_.straight_rad + std::clamp(habits_.contact_flexion_rad + depth, 0.0, habits_.range_rad);
}

}  // namespace jnd
