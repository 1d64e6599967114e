#include "devices/simulated_hand.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "devices/interval_key.h"
#include "protocols/input_error.h"
#include "protocols/random_stream.h"

namespace jnd {

namespace {

// Smooth passage from 0 to 1 without velocity at its ends.
double smooth(double s) noexcept {
  return s * s * (3 - 2 * s);
}

}  // namespace

SimulatedHand::SimulatedHand(const HandHabits& habits, int fingers, std::uint64_t seed, int participant)
    : habits_(habits), seed_(seed), participant_(participant) {
  const double gap = habits.separation_m / 2 - habits.sphere_radius_m;
  if (!(gap > 0))
    throw InputError(
        fmt::format("a sphere of radius {} m does not fit between fingers that rest {} m apart: make "
                    "$.rig.sphere_radius_m less than "
                    "half of $.rig.separation_m",
                    habits.sphere_radius_m, habits.separation_m));
  for (const double habit :
       {habits.sphere_radius_m, habits.press_depth_m, habits.closing_speed_m_per_s, habits.press_period_s})
    if (!(habit > 0))
      throw InputError(std::string("the simulated hand needs a positive depth, closing speed and press period"));
  approach_s_ = std::max(gap / habits.closing_speed_m_per_s, kLeastApproach_s);
  for (int finger = 0; finger < fingers; ++finger) {
    Finger next;
    next.side = finger == 0 ? -1 : 1;
    // Device z (dorsal) points away from the sphere, device x (distal) up; y completes the right-handed frame.
    next.axes.col(2) = Eigen::Vector3d(next.side, 0, 0);
    next.axes.col(0) = Eigen::Vector3d(0, 0, 1);
    next.axes.col(1) = Eigen::Vector3d(0, -next.side, 0);
    fingers_.push_back(std::move(next));
  }
}

void SimulatedHand::begin(const PresentRequest& request, std::int64_t start_ns) {
  start_ns_ = start_ns;
  const double presses = std::ceil(std::max(request.explore_s, request.no_contact_time_out_s) / habits_.press_period_s);
  const std::size_t needed = static_cast<std::size_t>(std::clamp(presses, 0.0, 1e5)) + 2;
  for (std::size_t finger = 0; finger < fingers_.size(); ++finger) {
    RandomStream random(seed_, static_cast<std::uint64_t>(participant_), "hand",
                        interval_part(request.id, static_cast<int>(finger)));
    fingers_[finger].presses.resize(needed);
    for (Press& press : fingers_[finger].presses) {
      do {
        press.depth_m = habits_.press_depth_m + habits_.press_depth_sd_m * random.normal();
      } while (press.depth_m <= std::min(kLeastPress_m, habits_.press_depth_m / 2));
      press.wander_y_m = habits_.lateral_sd_m * random.normal();
      press.wander_z_m = habits_.lateral_sd_m * random.normal();
    }
  }
}

double SimulatedHand::depth_m(int finger, double time_s) const noexcept {
  const std::vector<Press>& presses = fingers_[static_cast<std::size_t>(finger)].presses;
  if (presses.empty()) return habits_.sphere_radius_m - habits_.separation_m / 2;
  const double inside_s = kPressShare * habits_.press_period_s;
  // A press is half a sine; between presses the finger leaves and comes back at the speeds of the two halves.
  const double rate = std::numbers::pi / inside_s;
  if (time_s < approach_s_) {
    // Fifth-order passage from rest to the surface, arriving with the first press's speed and no acceleration.
    const double s = std::max(time_s, 0.0) / approach_s_, s3 = s * s * s;
    const double gap = habits_.separation_m / 2 - habits_.sphere_radius_m;
    const double arrival = std::min(presses[0].depth_m * rate * approach_s_, 1.5 * gap);
    return -gap * (1 - s3 * (10 - s * (15 - 6 * s))) - arrival * s3 * (1 - s) * (4 - 3 * s);
  }
  const double since = (time_s - approach_s_) / habits_.press_period_s;
  const std::size_t place = std::min(static_cast<std::size_t>(since), presses.size() - 1);
  const double in_period_s = (since - static_cast<double>(place)) * habits_.press_period_s;
  const double depth = presses[place].depth_m;
  if (in_period_s < inside_s) return depth * std::sin(rate * in_period_s);
  const double next = presses[std::min(place + 1, presses.size() - 1)].depth_m;
  const double outside_s = habits_.press_period_s - inside_s;
  const double s = std::min((in_period_s - inside_s) / outside_s, 1.0);
  return -outside_s * rate * s * (1 - s) * (depth * (1 - s) + next * s);
}

bool SimulatedHand::read(int finger, std::int64_t now_ns, FingerPose& pose) noexcept {
  const double time_s = 1e-9 * static_cast<double>(now_ns - start_ns_);
  const Finger& self = fingers_[static_cast<std::size_t>(finger)];
  pose.time_ns = now_ns;
  pose.device_axes = self.axes;
  double y = 0, z = 0;
  if (!self.presses.empty()) {
    const double since = std::max(time_s - approach_s_, 0.0) / habits_.press_period_s;
    const std::size_t place = std::min(static_cast<std::size_t>(since), self.presses.size() - 1);
    const Press& now = self.presses[place];
    const Press& next = self.presses[std::min(place + 1, self.presses.size() - 1)];
    const double passage = smooth(std::min(since - static_cast<double>(place), 1.0));
    y = now.wander_y_m + (next.wander_y_m - now.wander_y_m) * passage;
    z = now.wander_z_m + (next.wander_z_m - now.wander_z_m) * passage;
  }
  // A point at the wanted distance from the centre, in a direction that wanders: depth is along the normal.
  const double x = habits_.sphere_radius_m;
  const double distance = x - depth_m(finger, time_s);
  const double scale = distance / std::sqrt(x * x + y * y + z * z);
  pose.position_m = Eigen::Vector3d(self.side * x * scale, y * scale, z * scale);
  return true;
}

}  // namespace jnd
