// A model of the McKibben haptic finger behind the device seam: it resists the flexion of a finger that moves as it
// likes.
//
// The commanded force is Fref of the device's own force controller, which runs on the sensor's reading. While engaged
// and without force the controller regulates to zero force, so that the finger moves freely. When commands stop for
// longer than kMaxAge_ns, and after neutral(), the valve goes to 0 V at once and the muscle vents: within about 0.1 s
// from the force of a stiff object.
//
// What is assumed: the finger imposes its angle whatever the force; it stays within the usable range, where the linkage
// has its stops; the angle and what depends on it are straight lines within a millisecond.
#pragma once

#include <cstdint>

#include "devices/fingertip_device.h"
#include "devices/mckibben/mckibben_model.h"
#include "protocols/rigs/device_description.h"
#include "protocols/rigs/device_models.h"

namespace jnd {

// The finger's two sensors say what they make of the true angle and force. Const; nothing allocates or throws.
// Rotary encoder on the rocker: Baumer BDK, 1024 pulses a turn, each edge of one channel counted.
struct Encoder {
  double pulses_per_turn = 1024;  // 0: ideal
  double zero_rad = 0;            // where it counts from

  // The nearest position that the encoder can tell, rad.
  double read_rad(double angle_rad) const noexcept;
};

// Planar beam force sensor: Futek FR1020, 89 N. Its combined error of 0.25 % of the capacity, 0.22 N, is a bound on
// nonlinearity, hysteresis and repeatability and not noise: noise and quantisation depend on the amplifier and are
// given.
struct BeamForceSensor {
  double capacity_n = 89;
  double noise_sd_n = 0;    // 0: ideal
  double resolution_n = 0;  // 0: ideal
  std::uint64_t seed = 0;

  // The noise is a pure function of (seed, time): it does not depend on what was read before.
  double noise_n(std::int64_t time_ns) const noexcept;
  double read_n(double force_n, double noise_n) const noexcept;  // limited to the capacity, both ways
};

// Where a flexing finger's joint is at any time: what moves a model of the McKibben finger, as a person's finger would.
// Thread rule: const and safe within a tick; the control loop's thread.
class FingerFlexion {
 public:
  virtual ~FingerFlexion() = default;
  // Angle of the rocker, rad: alpha1 of the McKibben finger, at a time of the loop's clock.
  virtual double angle_rad(std::int64_t time_ns) const noexcept = 0;
};

struct MckibbenOptions {
  MckibbenParameters parameters;
  // PI, stable at every angle with both tendons. Under P alone (the paper's 0.28 V/N) the finger renders 64 % of an
  // object of 8 N/rad and 82 % of one of 50; under this within 0.1 % quasi-statically.
  ForceGains gains{.kp = 0.10, .ki = 3.0, .kd = 0};
  Tendon tendon = Tendon::unilateral;
  double max_force_n = hard_limits(DeviceModel::mckibben).force_n;  // of a command
  Encoder encoder;  // zero_rad is set by the device: it counts from the straight finger
  BeamForceSensor force_sensor;
};

// As the device's file describes it; seed of the force sensor's noise.
MckibbenOptions mckibben_options(const DeviceSpec& spec, std::uint64_t seed = 0);

class MckibbenDevice final : public FingertipDevice {
 public:
  // flexion must outlive the device. Throws InputError where the parameters do not make a finger.
  MckibbenDevice(const MckibbenOptions& options, const FingerFlexion& flexion);

  // Settled at zero force at the present angle. Lost where the angle is not a number; so are read and write from then
  // on.
  DeviceStatus engage(std::int64_t now_ns) noexcept override;
  // force_n of the force sensor, travel of the encoder (rad).
  DeviceStatus read(std::int64_t now_ns, DeviceReading& reading) noexcept override;
  // Uses force_n only, up to the options' max_force_n; before engage and after neutral it is ignored.
  DeviceStatus write(const DeviceCommand& command, std::int64_t now_ns) noexcept override;
  void neutral() noexcept override;

  const MckibbenModel& model() const noexcept { return model_; }
  // At the last read: of the encoder; of the true angle; of the valve's command; of the muscle.
  double joint_angle_rad() const noexcept;
  double true_angle_rad() const noexcept { return pose_.alpha1_rad; }
  double volts() const noexcept { return volts_; }
  double gauge_pa() const noexcept { return model_.gauge_pa(state_); }
  // Without sensor.
  double true_force_n() const noexcept { return model_.force_n(pose_, state_.muscle_pa); }

 private:
  static constexpr std::int64_t kStep_ns = 100'000;
  static constexpr int kStepsPerMs = 10;

  void advance_to(std::int64_t now_ns) noexcept;
  void begin_millisecond() noexcept;
  bool turn_to(std::int64_t time_ns, MckibbenPose& pose) noexcept;
  bool is_regulating() const noexcept;

  MckibbenModel model_;
  double max_force_n_;
  Encoder encoder_;
  BeamForceSensor force_sensor_;
  const FingerFlexion& flexion_;
  // State
  MckibbenState state_;
  MckibbenPose from_, to_, pose_;  // at both ends of the present millisecond, and now
  int substep_ = kStepsPerMs;      // of the present millisecond; all done: the next one is to begin
  std::int64_t time_ns_ = 0, written_ns_ = 0;
  double reference_n_ = 0;
  double sensor_error_n_ = 0;  // of the present millisecond
  double volts_ = 0;
  bool engaged_ = false, lost_ = false;
};

}  // namespace jnd
