#include "devices/control_loop.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "devices/rendering.h"

namespace jnd {

namespace {

std::int64_t ns_of(double seconds) noexcept {
  constexpr double kMost = 9e9;  // s; longer waits are as good as for ever
  return static_cast<std::int64_t>(std::llround(1e9 * std::clamp(seconds, 0.0, kMost)));
}

bool finite(const Eigen::Vector3d& v) noexcept {
  return std::isfinite(v.x() + v.y() + v.z());
}

}  // namespace

std::vector<TickRecord> TickRing::in_order() const {
  std::vector<TickRecord> records;
  const std::size_t kept = std::min(written_, kSize);
  for (std::size_t i = written_ - kept; i < written_; ++i) records.push_back(records_[i % kSize]);
  return records;
}

ControlLoop::ControlLoop(std::vector<FingertipDevice*> devices, Tracker& tracker, Clock& clock, const DeviceSpec& spec,
                         const Sphere& sphere)
    : fingers_(devices.size()), tracker_(tracker), clock_(clock), spec_(spec), sphere_(sphere) {
  for (std::size_t i = 0; i < devices.size(); ++i) {
    fingers_[i].device = devices[i];
    fingers_[i].governor.configure(spec);
  }
}

Fault ControlLoop::engage(const PresentRequest& request, std::int64_t start_ns) {
  ring_.clear();
  lateness_.clear();
  tracker_.begin(request, start_ns);
  Fault fault = Fault::none;
  for (std::size_t i = 0; i < fingers_.size(); ++i) {
    Finger& finger = fingers_[i];
    finger.summary.begin(request.stimulus.cues.force);
    finger.burst_until_ns = std::numeric_limits<std::int64_t>::min();
    finger.vibration_clamped = false;
    finger.pose = FingerPose{};
    finger.pose.time_ns = std::numeric_limits<std::int64_t>::min() / 2;  // none yet: stale
    finger.contact.begin(sphere_, Eigen::Vector3d(i == 0 && fingers_.size() > 1 ? -1 : 1, 0, 0));
    finger.governor.deactivate();
    finger.governor.reset();
    finger.governor.activate(start_ns);
    if (finger.device->engage(start_ns) != DeviceStatus::ok) fault = Fault::device_lost;
  }
  return fault;
}

Fault ControlLoop::tick_finger(int index, const PresentRequest& request, std::int64_t now_ns,
                               double duration_s) noexcept {
  Finger& finger = fingers_[static_cast<std::size_t>(index)];
  // read
  if (finger.device->read(now_ns, finger.reading) != DeviceStatus::ok) {
    finger.governor.trip(Fault::device_lost);
    return Fault::device_lost;
  }
  (void)tracker_.read(index, now_ns, finger.pose);  // without news the old pose grows stale, which the governor sees

  // contact
  const Contact& contact = finger.contact.update(finger.pose.position_m);
  touched_ = touched_ || contact.touching;

  // render
  const Stimulus& stimulus = request.stimulus;
  GovernorInput& input = finger.input;
  DeviceCommand& asked = input.asked;
  asked.force_n = asked.roll_rad = asked.pitch_rad = 0;
  asked.normal = Eigen::Vector3d::UnitZ();
  if (contact.touching && stimulus.cues.force) {
    asked.force_n = contact_force_n(stimulus.stiffness_n_per_m, contact.penetration_m);
    asked.normal.noalias() = finger.pose.device_axes.transpose() * contact.normal;
    const Tilt tilt = tilt_toward(asked.normal, finger.reading.platform.sin_yaw, finger.reading.platform.cos_yaw);
    asked.roll_rad = tilt.roll_rad;
    asked.pitch_rad = tilt.pitch_rad;
  }
  if (!finite(finger.pose.position_m)) asked.force_n = std::numeric_limits<double>::quiet_NaN();
  if (contact.event == ContactEvent::made && stimulus.cues.vibration) finger.burst_until_ns = now_ns + ns_of(kBurst_s);
  const bool burst = now_ns < finger.burst_until_ns;
  asked.vibration_g = burst ? burst_amplitude_g(stimulus.stiffness_n_per_m) : 0;
  asked.vibration_hz = burst ? kBurst_hz : 0;

  // governor
  input.platform_z_m = finger.reading.platform.pz_m;
  input.pose_time_ns = finger.pose.time_ns;
  const GovernorOutput out = finger.governor.govern(input, now_ns);

  // write
  const DeviceStatus written = finger.device->write(out.given, now_ns);

  // telemetry
  finger.summary.add({.duration_s = duration_s,
                      .touching = contact.touching,
                      .penetration_m = contact.penetration_m,
                      .force_n = finger.reading.force_n,
                      .force_reduced = out.force_reduced,
                      .soft_start = out.soft_start,
                      .vibration_g = finger.reading.vibration_g,
                      .vibration_clamped = (out.limits & limit::kVibration) != 0});
  ring_.next() = {.time_ns = now_ns,
                  .finger = index,
                  .penetration_m = contact.penetration_m,
                  .asked_n = asked.force_n,
                  .given_n = out.given.force_n,
                  .measured_n = finger.reading.force_n,
                  .vibration_g = out.given.vibration_g,
                  .limits = out.limits};
  if (out.fault != Fault::none) return out.fault;
  if (written != DeviceStatus::ok) {
    finger.governor.trip(Fault::device_lost);
    return Fault::device_lost;
  }
  return Fault::none;
}

void ControlLoop::stop_all(std::int64_t now_ns) noexcept {
  for (Finger& finger : fingers_) {
    (void)finger.device->write(DeviceCommand{}, now_ns);
    finger.device->neutral();
    finger.governor.deactivate();
  }
}

Fault ControlLoop::tick(const PresentRequest& request, std::int64_t now_ns, double duration_s, bool stop) noexcept {
  Fault fault = stop ? Fault::emergency_stop : Fault::none;
  touched_ = false;
  for (int index = 0; fault == Fault::none && index < static_cast<int>(fingers_.size()); ++index)
    fault = tick_finger(index, request, now_ns, duration_s);
  // One finger's fault stops all of them, in the same tick.
  if (fault != Fault::none) {
    for (Finger& finger : fingers_) finger.governor.trip(fault);
    stop_all(now_ns);
  }
  return fault;
}

Presentation ControlLoop::run(const PresentRequest& request, const std::atomic<bool>& stop) {
  Presentation result;
  const std::int64_t start_ns = clock_.now_ns();
  const std::int64_t explore_ns = ns_of(request.explore_s), time_out_ns = ns_of(request.no_contact_time_out_s);
  std::int64_t deadline_ns = start_ns, now_ns = start_ns, first_contact_ns = -1;
  result.fault = engage(request, start_ns);
  double duration_s = 1e-9 * static_cast<double>(kPeriod_ns);

  while (result.fault == Fault::none) {
    result.fault = tick(request, now_ns, duration_s, stop.load(std::memory_order_acquire));
    ++result.ticks;
    if (touched_ && first_contact_ns < 0 && result.fault == Fault::none) first_contact_ns = now_ns;
    if (result.fault != Fault::none) break;

    deadline_ns += kPeriod_ns;
    clock_.sleep_until_ns(deadline_ns);
    now_ns = clock_.now_ns();
    const std::int64_t late_ns = std::max<std::int64_t>(now_ns - deadline_ns, 0);
    lateness_.add(late_ns);
    const std::int64_t skipped = late_ns / kPeriod_ns;
    result.overruns += skipped;
    deadline_ns += skipped * kPeriod_ns;
    duration_s = 1e-9 * static_cast<double>((1 + skipped) * kPeriod_ns);

    // Deadlines, not wake-ups, end an interval: its length does not depend on the machine.
    if (first_contact_ns >= 0 && deadline_ns - first_contact_ns >= explore_ns) break;
    if (first_contact_ns < 0 && deadline_ns - start_ns >= time_out_ns) {
      result.fault = Fault::no_contact;
      break;
    }
  }
  stop_all(now_ns);
  result.duration_s = 1e-9 * static_cast<double>(now_ns - start_ns);
  if (first_contact_ns >= 0) result.first_contact_s = 1e-9 * static_cast<double>(first_contact_ns - start_ns);
  result.lateness_p50_us = lateness_.percentile_us(0.50);
  result.lateness_p99_us = lateness_.percentile_us(0.99);
  result.lateness_max_us = lateness_.largest_us();
  for (const Finger& finger : fingers_) result.fingers.push_back(finger.summary.result());
  return result;
}

}  // namespace jnd
