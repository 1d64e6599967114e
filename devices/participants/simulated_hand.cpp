#include "devices/participants/simulated_hand.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "protocols/input/input_error.h"
#include "protocols/random_stream.h"

namespace jnd {

namespace {

// Smooth passage from 0 to 1 without velocity at its ends.
double smooth(double s) noexcept {
  return s * s * (3 - 2 * s);
}

}  // namespace

PressMotion::PressMotion(double gap, double speed, double period_s) noexcept
    : gap_(gap), approach_s_(std::max(gap / speed, kLeastApproach_s)), period_s_(period_s) {}

std::size_t PressMotion::presses_in(double seconds) const noexcept {
  return static_cast<std::size_t>(std::clamp(std::ceil(seconds / period_s_), 0.0, 1e5)) + 2;
}

double PressMotion::depth(double time_s) const noexcept {
  if (depths_.empty()) return -gap_;
  const double inside_s = kPressShare * period_s_;
  // A press is half a sine; between presses the finger leaves and comes back at the speeds of the two halves.
  const double rate = std::numbers::pi / inside_s;
  if (time_s < approach_s_) {
    // Fifth-order passage from rest to the surface, arriving with the first press's speed and no acceleration.
    const double s = std::max(time_s, 0.0) / approach_s_, s3 = s * s * s;
    const double arrival = std::min(depths_[0] * rate * approach_s_, 1.5 * gap_);
    return -gap_ * (1 - s3 * (10 - s * (15 - 6 * s))) - arrival * s3 * (1 - s) * (4 - 3 * s);
  }
  const double since = (time_s - approach_s_) / period_s_;
  const std::size_t place = std::min(static_cast<std::size_t>(since), depths_.size() - 1);
  const double in_period_s = (since - static_cast<double>(place)) * period_s_;
  const double depth = depths_[place];
  if (in_period_s < inside_s) return depth * std::sin(rate * in_period_s);
  const double next = depths_[std::min(place + 1, depths_.size() - 1)];
  const double outside_s = period_s_ - inside_s;
  const double s = std::min((in_period_s - inside_s) / outside_s, 1.0);
  return -outside_s * rate * s * (1 - s) * (depth * (1 - s) + next * s);
}

SimulatedHand::SimulatedHand(const HandHabits& habits, int fingers, std::uint64_t seed, int participant)
    : habits_(habits), radius_m_(habits.sphere_radius_m), seed_(seed), participant_(participant) {
  const double gap = habits.separation_m / 2 - habits.sphere_radius_m;
  if (!(gap > 0))
    throw InputError(
        fmt::format("a sphere of radius {} m does not fit between fingers that rest {} m apart: make "
                    "$.rig.sphere_radius_m less than "
                    "half of $.rig.separation_m",
                    habits.sphere_radius_m, habits.separation_m));
  for (const auto& [name, radius_m] : habits.named_radius_m)
    if (!(radius_m > 0 && radius_m < habits.separation_m / 2))
      throw InputError(
          fmt::format("the object \"{}\" reaches {} m to a side and does not fit between fingers that rest {} m apart: "
                      "make $.rig.separation_m larger, or take another object",
                      name, radius_m, habits.separation_m));
  for (const double habit :
       {habits.sphere_radius_m, habits.press_depth_m, habits.closing_speed_m_per_s, habits.press_period_s})
    if (!(habit > 0))
      throw InputError(std::string("the simulated hand needs a positive depth, closing speed and press period"));
  const PressMotion motion(gap, habits.closing_speed_m_per_s, habits.press_period_s);
  approach_s_ = motion.approach_s();
  for (int finger = 0; finger < fingers; ++finger) {
    Finger next;
    next.side = finger == 0 ? -1 : 1;
    // Device z (dorsal) points away from the sphere, device x (distal) up; y completes the right-handed frame.
    next.axes.col(2) = Eigen::Vector3d(next.side, 0, 0);
    next.axes.col(0) = Eigen::Vector3d(0, 0, 1);
    next.axes.col(1) = Eigen::Vector3d(0, -next.side, 0);
    next.motion = motion;
    fingers_.push_back(std::move(next));
  }
}

void SimulatedHand::begin(const PresentRequest& request, std::int64_t start_ns) {
  start_ns_ = start_ns;
  const auto named = habits_.named_radius_m.find(request.object);
  radius_m_ = named == habits_.named_radius_m.end() ? habits_.sphere_radius_m : named->second;
  const PressMotion motion(habits_.separation_m / 2 - radius_m_, habits_.closing_speed_m_per_s, habits_.press_period_s);
  approach_s_ = motion.approach_s();
  for (std::size_t finger = 0; finger < fingers_.size(); ++finger) {
    Finger& self = fingers_[finger];
    self.motion = motion;
    const std::size_t needed = self.motion.presses_in(std::max(request.explore_s, request.no_contact_time_out_s));
    RandomStream random(seed_, static_cast<std::uint64_t>(participant_), "hand",
                        interval_part(request.id, static_cast<int>(finger)));
    std::vector<double> depths(needed);
    self.wanders.resize(needed);
    for (std::size_t press = 0; press < needed; ++press) {
      do {
        depths[press] = habits_.press_depth_m + habits_.press_depth_sd_m * random.normal();
      } while (depths[press] <= std::min(kLeastPress_m, habits_.press_depth_m / 2));
      self.wanders[press].y_m = habits_.lateral_sd_m * random.normal();
      self.wanders[press].z_m = habits_.lateral_sd_m * random.normal();
    }
    self.motion.set_depths(std::move(depths));
  }
}

double SimulatedHand::depth_m(int finger, double time_s) const noexcept {
  return fingers_[static_cast<std::size_t>(finger)].motion.depth(time_s);
}

bool SimulatedHand::read(int finger, std::int64_t now_ns, FingerPose& pose) noexcept {
  const double time_s = 1e-9 * static_cast<double>(now_ns - start_ns_);
  const Finger& self = fingers_[static_cast<std::size_t>(finger)];
  pose.time_ns = now_ns;
  pose.device_axes = self.axes;
  double y = 0, z = 0;
  if (!self.wanders.empty()) {
    const double since = std::max(time_s - approach_s_, 0.0) / habits_.press_period_s;
    const std::size_t place = std::min(static_cast<std::size_t>(since), self.wanders.size() - 1);
    const Wander& now = self.wanders[place];
    const Wander& next = self.wanders[std::min(place + 1, self.wanders.size() - 1)];
    const double passage = smooth(std::min(since - static_cast<double>(place), 1.0));
    y = now.y_m + (next.y_m - now.y_m) * passage;
    z = now.z_m + (next.z_m - now.z_m) * passage;
  }
  // A point at the wanted distance from the centre, in a direction that wanders: depth is along the normal.
  const double x = radius_m_;
  const double distance = x - depth_m(finger, time_s);
  const double scale = distance / std::sqrt(x * x + y * y + z * z);
  pose.position_m = Eigen::Vector3d(self.side * x * scale, y * scale, z * scale);
  return true;
}

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
