// A device on the bench: driven tick by tick through the governor, as the control loop drives it, and watched. And the
// list of what was checked.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "devices/check.h"
#include "devices/fingertip_device.h"
#include "devices/loop/governor.h"
#include "devices/mckibben/mckibben_device.h"
#include "protocols/rigs/rig_description.h"

namespace jnd {

// A finger that is where it was put, for models of joints.
class HeldFinger final : public FingerFlexion {
 public:
  double angle_rad(std::int64_t /*time_ns*/) const noexcept override { return angle_rad_; }
  void put(double angle_rad) noexcept { angle_rad_ = angle_rad; }

 private:
  double angle_rad_ = 0;
};

class DeviceBench {
 public:
  static constexpr std::int64_t kTick_ns = 1'000'000;

  // The model that the description asks for, as a study would build it; its joint, if it has one, in mid range.
  explicit DeviceBench(const DeviceSpec& spec);

  void engage();    // the device alone
  void activate();  // device and governor
  // Activated, with the soft start over and no force.
  void make_ready();

  // One tick of 1 ms: read, govern, write. The pose that the command rests on is age_ns old.
  const GovernorOutput& tick(const DeviceCommand& asked, std::int64_t age_ns = 0);
  void ticks(int count, const DeviceCommand& asked);
  // A millisecond without a command: the device is only read.
  void silence();
  // A command past the governor, as a mistake in a program would bring it.
  void write_raw(const DeviceCommand& command);

  // A push along the device's own direction.
  DeviceCommand push(double force_n) const;
  // Whether the device itself has let go: no torque, or a closed valve.
  bool lets_go() const;

  const DeviceSpec& spec() const noexcept { return spec_; }
  Governor& governor() noexcept { return governor_; }
  FingertipDevice& device() noexcept { return *device_; }
  HeldFinger& finger() noexcept { return *finger_; }
  const DeviceReading& reading() const noexcept { return reading_; }
  std::int64_t now_ns() const noexcept { return now_ns_; }

 private:
  DeviceSpec spec_;
  std::unique_ptr<HeldFinger> finger_ = std::make_unique<HeldFinger>();
  std::unique_ptr<FingertipDevice> device_;
  Governor governor_;
  GovernorOutput out_;
  DeviceReading reading_;
  std::int64_t now_ns_ = 0;
};

// The device alone, and the finger that moves it, for the loop.
std::unique_ptr<FingertipDevice> make_device(const DeviceSpec& spec, const FingerFlexion& finger);

// Everything that is checked of a rig's models.
Checks self_test_of(const RigSpec& rig);

// By subject.
void check_limits(const DeviceSpec& spec, Checks& checks);    // governor and device, any device
void check_loop(const RigSpec& rig, Checks& checks);          // the control loop with all the rig's devices
void check_platform(const DeviceSpec& spec, Checks& checks);  // 3RRS
void check_joint(const DeviceSpec& spec, Checks& checks);     // McKibben finger

}  // namespace jnd
