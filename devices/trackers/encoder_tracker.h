// The tracker of a rig that measures the finger itself: the encoder in a McKibben finger's joint.
#pragma once

#include <cmath>

#include "devices/mckibben/mckibben_device.h"
#include "devices/participants/simulated_hand.h"
#include "devices/tracker.h"

namespace jnd {

class EncoderTracker final : public Tracker {
 public:
  // The simulated finger moves the device; both must outlive the tracker. lever_arm_m: of the fingertip, for its place.
  EncoderTracker(const MckibbenDevice& device, SimulatedFlexion& finger, double straight_rad,
                 double lever_arm_m) noexcept
      : device_(device), finger_(finger), straight_rad_(straight_rad), lever_arm_m_(lever_arm_m) {}

  void begin(const PresentRequest& request, std::int64_t start_ns) override { finger_.begin(request, start_ns); }

  // The loop has read the device in the same tick: its angle is of now_ns.
  bool read(int /*finger*/, std::int64_t now_ns, FingerPose& pose) noexcept override {
    pose.flexion_rad = device_.joint_angle_rad() - straight_rad_;
    // World frame: x forward, z up, the joint at the origin; flexion lowers the fingertip.
    pose.position_m = {lever_arm_m_ * std::cos(pose.flexion_rad), 0, -lever_arm_m_ * std::sin(pose.flexion_rad)};
    pose.time_ns = now_ns;
    return true;
  }

 private:
  const MckibbenDevice& device_;
  SimulatedFlexion& finger_;
  double straight_rad_, lever_arm_m_;
};

}  // namespace jnd
