#include "devices/trackers/encoder_tracker.h"

#include <cmath>

namespace jnd {

bool EncoderTracker::read(int /*finger*/, std::int64_t now_ns, FingerPose& pose) noexcept {
  pose.flexion_rad = device_.joint_angle_rad() - straight_rad_;
  // World frame: x forward, z up, the joint at the origin; flexion lowers the fingertip.
  pose.position_m = {lever_arm_m_ * std::cos(pose.flexion_rad), 0, -lever_arm_m_ * std::sin(pose.flexion_rad)};
  pose.time_ns = now_ns;
  return true;
}

}  // namespace jnd
