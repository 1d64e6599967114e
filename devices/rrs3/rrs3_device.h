// A model of the 3RRS fingertip device of Chinello et al. 2017, pressing a compliant finger pulp: the controller, in
// front of the platform of rrs3_platform.h.
//
// Each millisecond the device turns the command into joint torques at the platform's actual pose, and lets those
// torques act, through the same pose's transmission, on the platform and the pulp. Roll and pitch are
// servo-positioned: they follow the command within the joints' speed. Rendering modes:
//   wrench      torques of w = [f n, 0] by (26): the finger gets f, whatever its own stiffness kf;
//   pd          position control in the platform's coordinates: the platform is sent force / stiffness into the finger
//               with the gain kS, and against the pulp renders kS kf / (kS + kf);
//   pd_literal  the same in the joints as printed, (36): off by its joint-secant error, and stiffer where it is tilted.
// A command without a stiffness (below 1 N/m) cannot be position-controlled: it is rendered as in `wrench`.
//
// What is assumed, because the paper prints none of it:
//   - the pulp is a linear spring (default 1000 N/m), always touched by the platform (compression 0 at rest);
//   - platform and linkage move as 5 g along the platform's normal, critically damped by servo gears and pulp, and in
//     the pd modes by Dq of (36) against the stiffness of gain and pulp together. So the delivered force never exceeds
//     the commanded one, and follows it in about 2 sqrt(m / kf) = 4.5 ms;
//   - torques are exact, the sensor under the platform is exact unless told otherwise, and the vibration motor starts
//     and stops at once.
//
// The device's own second line, behind the governor: a command that is not finite, or that does not push, gives no
// force; no force is above the specification's; without commands for 20 ms the device lets go.
#pragma once

#include <cstdint>

#include "analysis/numerics/special_values.h"
#include "devices/fingertip_device.h"
#include "devices/rrs3/rrs3_platform.h"
#include "devices/rrs3/vibration_motor.h"
#include "protocols/random_stream.h"
#include "protocols/rigs/device_description.h"
#include "protocols/vocabulary.h"

namespace jnd {

// A force sensor of a fingertip device, such as the piezoresistive one under the 3RRS platform (Chinello et al. 2017,
// figure 1): Gaussian noise, then steps, then a range. The paper prints no data of it: ideal unless told otherwise.
//
// Thread rule: one thread. A measurement does not allocate, lock or wait. The noise is counter-based: it depends on the
// seed, the part and the number of measurements since the part began, on nothing else.
struct ForceSensorOptions {
  double noise_sd_n = 0;    // of one measurement, N; independent of the next one's
  double resolution_n = 0;  // of a step, N; 0: continuous
  // What the converter can tell apart; beyond, it stays at the end. N.
  double min_n = -kInf;
  double max_n = kInf;
};

class ForceSensor {
 public:
  // Throws InputError where a figure is negative or not a number, or where the range is empty.
  explicit ForceSensor(const ForceSensorOptions& options = {}, std::uint64_t seed = 0);

  // From here on the noise is that of (seed, part): an interval's, for example.
  void begin(std::uint64_t part) noexcept;

  // What the sensor says, N. A force that is not a number stays one, so that it is found by who relies on it.
  double measure(double force_n) noexcept;

 private:
  ForceSensorOptions options_;
  std::uint64_t seed_;
  RandomStream noise_;
};

struct Rrs3DeviceOptions {
  double pulp_stiffness_n_per_m = 1000;
  RenderingMode mode = RenderingMode::wrench;
  ForceSensorOptions sensor = {};
  std::uint64_t seed = 0;  // of the sensor's noise
};

class Rrs3Device final : public FingertipDevice {
 public:
  // Throws InputError where the geometry cannot hold its rest pose, where the pulp is so soft that the largest force
  // would push the platform out of half its stroke, or where the sensor's figures are impossible.
  Rrs3Device(const DeviceSpec& spec, const Rrs3DeviceOptions& options);
  Rrs3Device(const DeviceSpec& spec, double pulp_stiffness_n_per_m)
      : Rrs3Device(spec, Rrs3DeviceOptions{.pulp_stiffness_n_per_m = pulp_stiffness_n_per_m}) {}

  DeviceStatus engage(std::int64_t now_ns) noexcept override;
  DeviceStatus read(std::int64_t now_ns, DeviceReading& reading) noexcept override;
  DeviceStatus write(const DeviceCommand& command, std::int64_t now_ns) noexcept override;
  void neutral() noexcept override;

  // The sensor's noise from the next engagement on is that of (seed, part): an interval's. Without it, parts count the
  // engagements.
  void begin_interval(std::uint64_t part) noexcept override { next_part_ = part; }

  // The joint torques of the last step, N m.
  const Eigen::Vector3d& torques() const noexcept { return torques_; }
  RenderingMode mode() const noexcept { return mode_; }

 private:
  void advance_to(std::int64_t now_ns) noexcept;
  void step() noexcept;
  bool position_controlled() const noexcept;
  double drive() noexcept;
  double drive_to_position() noexcept;
  void let_go() noexcept;

  Rrs3Platform platform_;
  double max_force_n_;
  RenderingMode mode_;
  ForceSensor sensor_;
  VibrationMotor motor_;
  // State
  DeviceCommand command_;
  std::uint64_t next_part_ = 0;
  std::int64_t time_ns_ = 0, written_ns_ = 0;
  Eigen::Vector3d torques_ = Eigen::Vector3d::Zero();
};

}  // namespace jnd
