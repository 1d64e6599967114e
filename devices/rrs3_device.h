// A model of the 3RRS fingertip device of Chinello et al. 2017 in `wrench` mode, pressing a compliant finger pulp.
//
// Each millisecond the device turns the commanded force into a wrench w = [f n, 0], into joint torques by (26) at the
// platform's actual pose, and lets those torques act, through the same pose's transmission, on the platform and the
// pulp. Roll and pitch are servo-positioned: they follow the command within the joints' speed.
//
// What is assumed, because the paper prints none of it:
//   - the pulp is a linear spring (default 1000 N/m), always touched by the platform (compression 0 at rest);
//   - platform and linkage move as 5 g along the platform's normal, critically damped by servo gears and pulp. So the
//     delivered force never exceeds the commanded one, and follows it in about 2 sqrt(m / kf) = 4.5 ms;
//   - torques are exact, the sensor under the platform is exact, and the vibration motor starts and stops at once.
#pragma once

#include "devices/fingertip_device.h"
#include "devices/rrs3_statics.h"
#include "protocols/device_spec.h"

namespace jnd {

inline constexpr double kPlatformMass_kg = 0.005;

class Rrs3Device final : public FingertipDevice {
 public:
  // Throws InputError where the geometry cannot hold its rest pose, or where the pulp is so soft that the largest force
  // would push the platform out of half its stroke.
  Rrs3Device(const DeviceSpec& spec, double pulp_stiffness_n_per_m);

  DeviceStatus engage(std::int64_t now_ns) noexcept override;
  DeviceStatus read(std::int64_t now_ns, DeviceReading& reading) noexcept override;
  DeviceStatus write(const DeviceCommand& command, std::int64_t now_ns) noexcept override;
  void neutral() noexcept override;

  // The joint torques of the last step, N m.
  const Eigen::Vector3d& torques() const noexcept { return torques_; }

 private:
  static constexpr std::int64_t kStep_ns = 1'000'000;

  void advance_to(std::int64_t now_ns) noexcept;
  void step() noexcept;
  bool solve_pose(const Rrs3Coordinates& at) noexcept;
  double drive() noexcept;
  bool turn() noexcept;

  Rrs3Kinematics kinematics_;
  double pulp_n_per_m_;
  double joint_step_rad_;                                  // farthest turn of a joint in one step
  double decay_, from_velocity_, onto_velocity_, damped_;  // exact solution of the critically damped step
  // State
  DeviceCommand command_;
  std::int64_t time_ns_ = 0, written_ns_ = 0;
  double compression_m_ = 0, velocity_m_per_s_ = 0;  // of the pulp, along the platform's normal
  Rrs3Coordinates at_;
  Rrs3Configuration configuration_;
  Rrs3Differential differential_;
  Rrs3Configuration rest_configuration_;
  Rrs3Differential rest_differential_;
  Eigen::Vector3d torques_ = Eigen::Vector3d::Zero();
};

}  // namespace jnd
