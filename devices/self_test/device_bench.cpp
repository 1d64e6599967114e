#include "devices/self_test/device_bench.h"

#include "devices/mckibben/mckibben_device.h"
#include "devices/rrs3/rrs3_device.h"

namespace jnd {

std::unique_ptr<FingertipDevice> make_device(const DeviceSpec& spec, const FingerFlexion& finger) {
  switch (spec.model) {
    case DeviceModel::rrs3: {
      Rrs3DeviceOptions options;
      options.sensor.noise_sd_n = spec.sensors.force_noise_sd_n;
      options.sensor.resolution_n = spec.sensors.force_resolution_n;
      return std::make_unique<Rrs3Device>(spec, options);
    }
    case DeviceModel::mckibben:
      break;
  }
  return std::make_unique<MckibbenDevice>(mckibben_options(spec), finger);
}

DeviceBench::DeviceBench(const DeviceSpec& spec) : spec_(spec) {
  finger_->put((spec.lowest_travel + spec.highest_travel) / 2);
  device_ = make_device(spec, *finger_);
  governor_.configure(spec);
}

void DeviceBench::engage() {
  (void)device_->engage(now_ns_);
}

void DeviceBench::activate() {
  engage();
  governor_.activate(now_ns_);
}

void DeviceBench::make_ready() {
  activate();
  ticks(static_cast<int>(kSoftStart_ns / kTick_ns) + 1, push(0));
}

const GovernorOutput& DeviceBench::tick(const DeviceCommand& asked, std::int64_t age_ns) {
  now_ns_ += kTick_ns;
  (void)device_->read(now_ns_, reading_);
  out_ = governor_.govern({.asked = asked, .travel = reading_.travel, .pose_time_ns = now_ns_ - age_ns}, now_ns_);
  (void)device_->write(out_.given, now_ns_);
  return out_;
}

void DeviceBench::ticks(int count, const DeviceCommand& asked) {
  for (int i = 0; i < count; ++i) (void)tick(asked);
}

void DeviceBench::silence() {
  now_ns_ += kTick_ns;
  (void)device_->read(now_ns_, reading_);
}

void DeviceBench::write_raw(const DeviceCommand& command) {
  now_ns_ += kTick_ns;
  (void)device_->read(now_ns_, reading_);
  (void)device_->write(command, now_ns_);
}

DeviceCommand DeviceBench::push(double force_n) const {
  DeviceCommand command;
  command.force_n = force_n;
  return command;
}

bool DeviceBench::lets_go() const {
  if (const auto* platform = dynamic_cast<const Rrs3Device*>(device_.get())) return platform->torques().isZero(0);
  if (const auto* joint = dynamic_cast<const MckibbenDevice*>(device_.get())) return joint->volts() == 0;
  return false;
}

Checks self_test_of(const RigSpec& rig) {
  Checks checks;
  for (const DeviceSpec& device : rig.devices) {
    check_limits(device, checks);
    switch (device.model) {
      case DeviceModel::rrs3:
        check_platform(device, checks);
        break;
      case DeviceModel::mckibben:
        check_joint(device, checks);
        break;
    }
  }
  check_loop(rig, checks);
  return checks;
}

}  // namespace jnd
