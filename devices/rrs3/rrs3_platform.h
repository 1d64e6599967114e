// The moving part of the 3RRS fingertip device, without its controller: platform and linkage as 5 g that press a
// compliant pulp along the platform's normal, and servos that turn it. Rrs3Device puts the control law in front of it;
// the virtual device puts real firmware there.
//
// What is assumed stands in rrs3_device.h. A step is one millisecond, and exact for a force that is constant within it.
//
// Thread rule: one thread. Nothing allocates, locks or throws after construction.
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "devices/fingertip_device.h"
#include "devices/rrs3/rrs3_kinematics.h"
#include "devices/rrs3/rrs3_statics.h"
#include "protocols/rigs/device_description.h"

namespace jnd {

inline constexpr double kPlatformMass_kg = 0.005;
inline constexpr std::int64_t kPlatformStep_ns = 1'000'000;

// What the actuators do during one step.
struct PlatformDrive {
  double force_n = 0;       // along the platform's normal, into the finger: Rrs3Platform::force_of the joint torques
  double hold_n_per_m = 0;  // above 0: the servos hold the position with this gain, the force falls as it moves
  double roll_rad = 0, pitch_rad = 0;  // how the platform should lie
};

class Rrs3Platform {
 public:
  // Throws InputError where the geometry cannot hold its rest pose, or where the pulp is so soft that the largest force
  // would push the platform out of half its stroke.
  Rrs3Platform(const DeviceSpec& spec, double pulp_stiffness_n_per_m);

  // To the rest pose, without motion.
  void rest() noexcept;
  void step(const PlatformDrive& drive) noexcept;

  // What torques of the joints (N m) put on the platform along its normal here, N.
  double force_of(const Eigen::Vector3d& torques) const noexcept;

  double force_n() const noexcept { return pulp_n_per_m_ * compression_m_; }  // on the finger
  double compression_m() const noexcept { return compression_m_; }            // of the pulp, along the normal; >= 0
  double velocity_m_per_s() const noexcept { return velocity_m_per_s_; }      // the same, into the finger
  Eigen::Vector3d normal() const noexcept { return configuration_.rotation.col(2); }
  Eigen::Vector3d joint_angles() const noexcept { return kinematics_.joint_angles(configuration_); }

  const Rrs3Kinematics& kinematics() const noexcept { return kinematics_; }
  const Rrs3Coordinates& coordinates() const noexcept { return at_; }
  const Rrs3Configuration& configuration() const noexcept { return configuration_; }
  const Rrs3Differential& differential() const noexcept { return differential_; }
  PlatformPose pose() const noexcept;

 private:
  // One step of m u'' + 2 sqrt(m k) u' + k (u - settled) = 0, exact.
  struct Motion {
    double stiffness_n_per_m = 0;
    double decay = 0, from_velocity = 0, onto_velocity = 0, damped = 0;
  };
  static Motion motion_of(double stiffness_n_per_m) noexcept;

  bool solve_pose(const Rrs3Coordinates& at) noexcept;
  bool turn(const PlatformDrive& drive) noexcept;

  Rrs3Kinematics kinematics_;
  double pulp_n_per_m_;
  double joint_step_rad_;  // farthest turn of a joint in one step
  Motion free_;            // against the pulp alone
  Motion held_;            // against pulp and gain, of the gain last held
  // State
  double compression_m_ = 0, velocity_m_per_s_ = 0;
  Rrs3Coordinates at_;
  Rrs3Configuration configuration_;
  Rrs3Differential differential_;
  Rrs3Configuration rest_configuration_;
  Rrs3Differential rest_differential_;
};

}  // namespace jnd
