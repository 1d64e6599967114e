#include "devices/participants/press_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace jnd {

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

}  // namespace jnd
