// The seam between the control loop and whatever knows where the fingers are.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "devices/rig.h"

namespace jnd {

// World frame: origin in the middle between the fingers' rest positions, x from thumb to index, z up. SI units.
struct FingerPose {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();       // of the fingertip
  Eigen::Matrix3d device_axes = Eigen::Matrix3d::Identity();  // columns: the device frame's axes in the world
  double flexion_rad = 0;                                     // of the joint from straight, where one is tracked
  std::int64_t time_ns = 0;                                   // when it was true, on the loop's clock
};

// Thread rule: the control loop's thread only.
class Tracker {
 public:
  virtual ~Tracker() = default;
  // An interval begins at start_ns. May allocate; called outside the tick.
  virtual void begin(const PresentRequest& request, std::int64_t start_ns) = 0;
  // The newest pose. False where there has been none yet; pose is then unchanged.
  virtual bool read(int finger, std::int64_t now_ns, FingerPose& pose) noexcept = 0;

  // The stream of poses; none for a tracker inside the program. Any thread.
  virtual std::optional<TrackerReport> report() const { return std::nullopt; }
  // What is missing, in the operator's words; empty: nothing. Any thread.
  virtual std::string missing() const { return {}; }
  // The same without the words of the tracker's program, which may tell the stimulus.
  virtual std::string missing_sealed() const { return missing(); }
};

}  // namespace jnd
