// A rig's control loop, measured with all its devices: how soon a stop is a stop.
#include <algorithm>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "devices/loop/control_loop.h"
#include "devices/self_test/device_bench.h"

namespace jnd {

namespace {

constexpr double kDepth_m = 0.004, kRadius_m = 0.065, kDepth_rad = 0.2;
constexpr int kPressing_ticks = 400;  // the soft start is over

// A finger that rests inside the object from the beginning, and that is lost at some tick.
class RestingFinger final : public Tracker {
 public:
  RestingFinger(double flexion_rad, int lost_after_ticks) : lost_after_ticks_(lost_after_ticks) {
    pose_.position_m = Eigen::Vector3d(kRadius_m - kDepth_m, 0, 0);
    // The device's z is the object's outward normal, x.
    pose_.device_axes.col(0) = -Eigen::Vector3d::UnitZ();
    pose_.device_axes.col(1) = Eigen::Vector3d::UnitY();
    pose_.device_axes.col(2) = Eigen::Vector3d::UnitX();
    pose_.flexion_rad = flexion_rad;
  }
  void begin(const PresentRequest& /*request*/, std::int64_t start_ns) override { start_ns_ = start_ns; }
  bool read(int /*finger*/, std::int64_t now_ns, FingerPose& pose) noexcept override {
    if (lost_after_ticks_ < 0 || now_ns - start_ns_ <= lost_after_ticks_ * kPeriod_ns) pose_.time_ns = now_ns;
    pose = pose_;
    return true;
  }

 private:
  FingerPose pose_;
  int lost_after_ticks_;
  std::int64_t start_ns_ = 0;
};

// Passes everything on, and notes the force of each command.
class WatchedDevice final : public FingertipDevice {
 public:
  WatchedDevice(std::unique_ptr<FingertipDevice> device, EmergencyStop& stop, int latch_after_ticks)
      : device_(std::move(device)), stop_(stop), latch_after_ticks_(latch_after_ticks) {
    forces_n_.reserve(10'000);
  }
  void begin_interval(std::uint64_t part) noexcept override { device_->begin_interval(part); }
  DeviceStatus engage(std::int64_t now_ns) noexcept override { return device_->engage(now_ns); }
  DeviceStatus read(std::int64_t now_ns, DeviceReading& reading) noexcept override {
    return device_->read(now_ns, reading);
  }
  DeviceStatus write(const DeviceCommand& command, std::int64_t now_ns) noexcept override {
    if (forces_n_.size() < forces_n_.capacity()) forces_n_.push_back(command.force_n);
    if (static_cast<int>(forces_n_.size()) == latch_after_ticks_) stop_.latch(StopSource::button);
    return device_->write(command, now_ns);
  }
  void neutral() noexcept override {
    device_->neutral();
    // At once: the device has nothing to wait for. Only what comes before the end counts.
    neutral_after_ = static_cast<int>(forces_n_.size());
  }

  double force_at(int tick) const {
    return tick < static_cast<int>(forces_n_.size()) ? forces_n_[static_cast<std::size_t>(tick)] : 0;
  }
  // Ticks from one on to the first without force: the next one is 1.
  int ticks_to_zero(int from) const {
    int ticks = 1;
    while (from + ticks < static_cast<int>(forces_n_.size()) && force_at(from + ticks) != 0) ++ticks;
    return ticks;
  }
  int neutral_after() const noexcept { return neutral_after_; }

 private:
  std::unique_ptr<FingertipDevice> device_;
  EmergencyStop& stop_;
  int latch_after_ticks_;  // writes; negative: never
  std::vector<double> forces_n_;
  int neutral_after_ = 0;
};

struct Run {
  Presentation presentation;
  double force_before_n = 0;  // the least of the devices, in the tick of the event
  int ticks_to_zero = 0;      // the slowest of the devices
  bool neutral = true;        // all of them were told to go to rest at the end
};

Run run_loop(const RigSpec& rig, int latch_after_ticks, int lost_after_ticks, int event_tick) {
  EmergencyStop stop;
  SimulatedClock clock(0);
  HeldFinger finger;
  LoopScene scene;
  scene.object = sphere_object({.radius_m = kRadius_m});
  double flexion_rad = 0;
  std::vector<std::unique_ptr<WatchedDevice>> devices;
  std::vector<LoopDevice> channels;
  for (const DeviceSpec& spec : rig.devices) {
    const bool joint = facts_of(spec.model).acts_on_joint;
    if (joint) {
      const double range = spec.highest_travel - spec.lowest_travel;
      flexion_rad = range / 2;
      finger.put(spec.lowest_travel + flexion_rad);
      const double per_rad = rig.devices.size() > 1 ? kDepth_m / kDepth_rad : 1;
      scene.joint = JointObject{.contact_flexion_rad = flexion_rad - kDepth_rad, .penetration_per_rad = per_rad};
    }
    devices.push_back(
        std::make_unique<WatchedDevice>(make_device(spec, finger), stop, devices.empty() ? latch_after_ticks : -1));
    LoopDevice channel;
    channel.device = devices.back().get();
    channel.spec = spec;
    channel.channel = joint ? Channel::kinaesthetic : Channel::cutaneous;
    channels.push_back(channel);
  }
  RestingFinger tracker(flexion_rad, lost_after_ticks);
  ControlLoop loop(channels, tracker, clock, scene);
  const bool only_joint = rig.cutaneous() == nullptr;
  PresentRequest request;
  request.stimulus.stiffness = only_joint ? 20 : 500;
  request.stimulus.cues = {.force = true, .vibration = false, .kinaesthetic = true};
  request.explore_s = 2;
  request.no_contact_time_out_s = 1;
  Run run;
  run.presentation = loop.run(request, stop);
  run.force_before_n = devices.front()->force_at(event_tick);
  for (const auto& device : devices) {
    run.force_before_n = std::min(run.force_before_n, device->force_at(event_tick));
    run.ticks_to_zero = std::max(run.ticks_to_zero, device->ticks_to_zero(event_tick));
    run.neutral = run.neutral && device->neutral_after() > 0;
  }
  return run;
}

}  // namespace

void check_loop(const RigSpec& rig, Checks& checks) {
  const auto add = [&](Check check) {
    check.device = rig.name;
    checks.push_back(std::move(check));
  };
  constexpr int kStopTicks = 2;
  const Run stopped = run_loop(rig, kPressing_ticks, -1, kPressing_ticks - 1);
  add(measured(fmt::format("emergency stop while pressing with {:.2f} N", stopped.force_before_n),
               fmt::format("0 N after {} tick{}", stopped.ticks_to_zero, stopped.ticks_to_zero == 1 ? "" : "s"),
               fmt::format("at most {} ticks", kStopTicks),
               stopped.force_before_n > 0 && stopped.ticks_to_zero <= kStopTicks &&
                   stopped.presentation.fault == Fault::emergency_stop && stopped.neutral));

  constexpr int kAge_ticks = static_cast<int>(kMaxAge_ns / kPeriod_ns);
  const Run lost = run_loop(rig, -1, kPressing_ticks, kPressing_ticks);
  add(measured(fmt::format("tracker lost while pressing with {:.2f} N", lost.force_before_n),
               fmt::format("{}, 0 N after {} ticks", to_string(lost.presentation.fault), lost.ticks_to_zero),
               fmt::format("stale_pose, at most {} + 1 ticks", kAge_ticks),
               lost.force_before_n > 0 && lost.presentation.fault == Fault::stale_pose &&
                   lost.ticks_to_zero <= kAge_ticks + 1 && lost.neutral));

  const Run whole = run_loop(rig, -1, -1, kPressing_ticks);
  add(measured("a whole presentation of 2 s",
               fmt::format("{} ticks, {}", whole.presentation.ticks, to_string(whole.presentation.fault)),
               "2000 ticks, none",
               whole.presentation.fault == Fault::none && whole.presentation.ticks >= 2000 &&
                   whole.presentation.ticks <= 2002 && whole.neutral));
}

}  // namespace jnd
