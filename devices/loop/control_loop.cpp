#include "devices/loop/control_loop.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "analysis/numerics/special_values.h"
#include "devices/loop/rendering.h"
#include "devices/rig.h"

namespace jnd {

namespace {

constexpr double kPeriod_s = 1e-9 * static_cast<double>(kPeriod_ns);
constexpr std::int64_t kSnapshotEvery_ticks = 25;  // what an operator sees is no older than this
constexpr std::int64_t kAskEvery_ticks = 50;       // whether it is enough

std::int64_t ns_of(double seconds) noexcept {
  constexpr double kMost = 9e9;  // s; longer waits are as good as for ever
  return static_cast<std::int64_t>(std::llround(1e9 * std::clamp(seconds, 0.0, kMost)));
}

bool finite(const FingerPose& pose) noexcept {
  return std::isfinite(pose.position_m.x() + pose.position_m.y() + pose.position_m.z() + pose.flexion_rad);
}

bool finite(const DeviceReading& reading) noexcept {
  return std::isfinite(reading.force_n + reading.vibration_g + reading.travel + reading.platform.sin_yaw +
                       reading.platform.cos_yaw);
}

Fault fault_of(DeviceStatus status) noexcept {
  switch (status) {
    case DeviceStatus::ok:
      return Fault::none;
    case DeviceStatus::lost:
      return Fault::device_lost;
    case DeviceStatus::stopped:
      return Fault::device_fault;
  }
  return Fault::device_lost;
}

bool has_force(const Cues& cues, Channel channel) noexcept {
  return channel == Channel::cutaneous ? cues.force : cues.kinaesthetic;
}

}  // namespace

ControlLoop::ControlLoop(const std::vector<LoopDevice>& devices, Tracker& tracker, Clock& clock, const LoopScene& scene,
                         const LoopListeners& listeners)
    : devices_(devices.size()), tracker_(tracker), clock_(clock), scene_(scene), listeners_(listeners) {
  for (std::size_t i = 0; i < devices.size(); ++i) {
    devices_[i].setup = devices[i];
    devices_[i].governor.configure(devices[i].spec);
    fingers_.resize(std::max(fingers_.size(), static_cast<std::size_t>(devices[i].finger) + 1));
  }
}

const VirtualObject& ControlLoop::object_of(const PresentRequest& request) const {
  if (request.object.empty()) return scene_.object;
  const auto found = scene_.named.find(request.object);
  if (found == scene_.named.end())
    throw std::invalid_argument("the rig was built without the object " + request.object);
  return found->second;
}

Fault ControlLoop::engage(const PresentRequest& request, std::int64_t start_ns) {
  const VirtualObject& object = object_of(request);
  ring_.clear();
  lateness_.clear();
  late_ns_ = 0;
  touched_ = false;
  over_.store(false, std::memory_order_relaxed);
  tracker_.begin(request, start_ns);
  for (std::size_t i = 0; i < fingers_.size(); ++i) {
    Finger& finger = fingers_[i];
    finger.burst_until_ns = request.tap_g > 0 ? start_ns + ns_of(kBurst_s) : std::numeric_limits<std::int64_t>::min();
    finger.penetration = finger.penetration_rate = 0;
    finger.contacts_ended = 0;
    finger.pose = FingerPose{};
    finger.pose.time_ns = std::numeric_limits<std::int64_t>::min() / 2;  // none yet: stale
    finger.object.begin(object, Eigen::Vector3d(i == 0 ? -1 : 1, 0, 0));
    if (scene_.joint) finger.joint.begin(*scene_.joint);
  }
  Fault fault = Fault::none;
  for (Channeled& one : devices_) {
    // A joint's device works along its own lever arm times the angle.
    const double path = scene_.joint && one.setup.channel == Channel::kinaesthetic
                            ? one.setup.spec.lever_arm_m / scene_.joint->penetration_per_rad
                            : 1;
    one.summary.begin(has_force(request.stimulus.cues, one.setup.channel), path);
    one.watch.begin();
    one.governor.deactivate();
    one.governor.reset();
    one.governor.activate(start_ns);
    one.setup.device->begin_interval(interval_part(request.id, one.setup.finger));
    if (const Fault found = fault_of(one.setup.device->engage(start_ns)); found != Fault::none) fault = found;
  }
  return fault;
}

Fault ControlLoop::read(std::int64_t now_ns) noexcept {
  for (Channeled& one : devices_) {
    if (const Fault found = fault_of(one.setup.device->read(now_ns, one.reading)); found != Fault::none) return found;
    if (!finite(one.reading)) return Fault::non_finite;
    const std::int64_t age_ns = now_ns - one.reading.time_ns;
    if (age_ns > kMaxAge_ns || age_ns < -kMaxAge_ns) return Fault::stale_reading;
  }
  // Without a new pose the old one grows stale, which the governor sees.
  for (std::size_t i = 0; i < fingers_.size(); ++i) (void)tracker_.read(static_cast<int>(i), now_ns, fingers_[i].pose);
  return Fault::none;
}

const Contact& ControlLoop::contact_of(const Finger& finger) const noexcept {
  return scene_.joint ? finger.joint.contact() : finger.object.contact();
}

void ControlLoop::update_contact(const PresentRequest& request, std::int64_t now_ns, double duration_s) noexcept {
  touched_ = false;
  if (request.tap_g > 0) return;  // there is nothing to touch
  for (Finger& finger : fingers_) {
    const Contact& contact =
        scene_.joint ? finger.joint.update(finger.pose.flexion_rad) : finger.object.update(finger.pose.position_m);
    touched_ = touched_ || contact.touching;
    finger.penetration_rate = (contact.penetration_m - finger.penetration) / duration_s;
    finger.penetration = contact.penetration_m;
    if (contact.event == ContactEvent::broken) ++finger.contacts_ended;
    if (contact.event == ContactEvent::made && request.stimulus.cues.vibration)
      finger.burst_until_ns = now_ns + ns_of(kBurst_s);
  }
}

void ControlLoop::render(Channeled& one, const PresentRequest& request, std::int64_t now_ns) const noexcept {
  const Stimulus& stimulus = request.stimulus;
  const Finger& finger = fingers_[static_cast<std::size_t>(one.setup.finger)];
  const Contact& contact = contact_of(finger);
  DeviceCommand& asked = one.input.asked;
  asked = DeviceCommand{};
  if (contact.touching && has_force(stimulus.cues, one.setup.channel)) {
    asked.force_n = one.setup.force_gain * contact_force_n(stimulus.stiffness, contact.penetration_m,
                                                           stimulus.damping_n_s_per_m, finger.penetration_rate);
    asked.stiffness_n_per_m = stimulus.stiffness;
    asked.damping_n_s_per_m = stimulus.damping_n_s_per_m;
    asked.penetration_m = contact.penetration_m;
    asked.penetration_rate_m_per_s = finger.penetration_rate;
    if (one.setup.channel == Channel::cutaneous && !scene_.joint) {
      asked.normal.noalias() = finger.pose.device_axes.transpose() * contact.normal;
      asked.contact_point_m.noalias() =
          finger.pose.device_axes.transpose() * (contact.proxy_m - finger.pose.position_m);
      const Tilt tilt = tilt_toward(asked.normal, one.reading.platform.sin_yaw, one.reading.platform.cos_yaw);
      asked.roll_rad = tilt.roll_rad;
      asked.pitch_rad = tilt.pitch_rad;
    }
  }
  if (!finite(finger.pose)) asked.force_n = kNaN;
  if (one.setup.channel == Channel::cutaneous && now_ns < finger.burst_until_ns) {
    asked.vibration_g = request.tap_g > 0 ? request.tap_g : burst_amplitude_g(stimulus.stiffness);
    asked.vibration_hz = kBurst_hz;
  }
  one.input.travel = one.reading.travel;
  one.input.pose_time_ns = finger.pose.time_ns;
}

void ControlLoop::record(int place, const GovernorOutput& out, std::int64_t now_ns, double duration_s) noexcept {
  Channeled& one = devices_[static_cast<std::size_t>(place)];
  const Finger& finger = fingers_[static_cast<std::size_t>(one.setup.finger)];
  const Contact& contact = contact_of(finger);
  one.summary.add({.duration_s = duration_s,
                   .touching = contact.touching,
                   .penetration = contact.penetration_m,
                   .force_n = one.reading.force_n,
                   .force_reduced = out.force_reduced,
                   .soft_start = out.soft_start,
                   .vibration_g = one.reading.vibration_g,
                   .vibration_clamped = (out.limits & limit::kVibration) != 0});
  TickRecord& tick = ring_.next();
  tick.time_ns = now_ns;
  tick.lateness_ns = late_ns_;
  tick.channel = place;
  tick.limits = out.limits;
  tick.penetration = contact.penetration_m;
  tick.asked_n = one.input.asked.force_n;
  tick.given_n = out.given.force_n;
  tick.measured_n = one.reading.force_n;
  tick.vibration_g = out.given.vibration_g;
  tick.travel = one.reading.travel;
  tick.finger_m = {finger.pose.position_m.x(), finger.pose.position_m.y(), finger.pose.position_m.z()};
  for (TelemetryRing* ring : {listeners_.telemetry, listeners_.live})
    if (ring != nullptr) ring->push(tick);
}

Fault ControlLoop::act(int place, const PresentRequest& request, std::int64_t now_ns, double duration_s) noexcept {
  Channeled& one = devices_[static_cast<std::size_t>(place)];
  render(one, request, now_ns);
  const GovernorOutput out = one.governor.govern(one.input, now_ns);
  const DeviceStatus written = one.setup.device->write(out.given, now_ns);
  record(place, out, now_ns, duration_s);
  if (out.fault != Fault::none) return out.fault;
  if (const Fault found = fault_of(written); found != Fault::none) return found;
  if (one.watch.stuck(one.reading.force_n, out.given.force_n, now_ns)) return Fault::sensor_stuck;
  return Fault::none;
}

void ControlLoop::stop_all(std::int64_t now_ns) noexcept {
  for (Channeled& one : devices_) {
    (void)one.setup.device->write(DeviceCommand{}, now_ns);
    one.setup.device->neutral();
    one.governor.deactivate();
  }
}

void ControlLoop::show(std::int64_t ticks, double elapsed_s) noexcept {
  LoopSnapshot snapshot;
  snapshot.ticks = ticks;
  snapshot.elapsed_s = elapsed_s;
  snapshot.lateness_max_us = lateness_.largest_us();
  snapshot.contact = touched_;
  listeners_.snapshot->put(snapshot);
}

Fault ControlLoop::tick(const PresentRequest& request, std::int64_t now_ns, double duration_s, bool stop) noexcept {
  Fault fault = stop ? Fault::emergency_stop : read(now_ns);
  if (fault == Fault::none) {
    update_contact(request, now_ns, duration_s);
    for (int place = 0; fault == Fault::none && place < static_cast<int>(devices_.size()); ++place)
      fault = act(place, request, now_ns, duration_s);
  }
  // One device's fault stops all of them, in the same tick.
  if (fault != Fault::none) {
    for (Channeled& one : devices_) one.governor.trip(fault);
    stop_all(now_ns);
  }
  return fault;
}

void ControlLoop::summarise(Presentation& result) const {
  result.lateness_p50_us = lateness_.percentile_us(0.50);
  result.lateness_p99_us = lateness_.percentile_us(0.99);
  result.lateness_max_us = lateness_.largest_us();
  result.lateness_histogram = lateness_.by_edges();
  for (const Channeled& one : devices_) {
    FingerPresentation summary = one.summary.result();
    summary.finger = one.setup.finger;
    summary.channel = one.setup.channel;
    if (summary.stiffness) {
      const double slope = *summary.stiffness;
      *summary.stiffness /= one.setup.force_gain;
      if (summary.stiffness_se) *summary.stiffness_se /= one.setup.force_gain;
      // The device's force acts at its own lever arm; penetration is penetration_per_rad times the angle.
      if (one.setup.channel == Channel::kinaesthetic && scene_.joint)
        summary.joint_stiffness_n_m_per_rad = slope * one.setup.spec.lever_arm_m * scene_.joint->penetration_per_rad;
    }
    for (std::size_t bit = 0; bit < limit::kNames.size(); ++bit) {
      const LimitTally& tally = one.governor.tallies()[bit];
      if (tally.ticks > 0)
        summary.interventions.push_back({std::string(limit::kNames[bit]), tally.ticks, tally.asked, tally.given});
    }
    result.fingers.push_back(std::move(summary));
  }
  if (result.fault != Fault::none && result.fault != Fault::no_contact)
    result.last_ticks = ring_.in_order(kTicksBeforeStop * devices_.size());
}

bool ControlLoop::ended_early(const PresentRequest& request, std::int64_t ticks) const {
  if (over_.load(std::memory_order_relaxed)) return true;
  if (request.enough && ticks % kAskEvery_ticks == 0 && request.enough()) return true;
  return request.contacts > 0 && std::any_of(fingers_.begin(), fingers_.end(), [&](const Finger& finger) {
           return finger.contacts_ended >= request.contacts;
         });
}

Presentation ControlLoop::run(const PresentRequest& request, const EmergencyStop& stop) {
  Presentation result;
  const std::int64_t start_ns = clock_.now_ns();
  const std::int64_t explore_ns = ns_of(request.explore_s), time_out_ns = ns_of(request.no_contact_time_out_s);
  std::int64_t deadline_ns = start_ns, now_ns = start_ns, first_contact_ns = -1;
  const bool free = !request.object.empty() || request.tap_g > 0;
  result.fault = engage(request, start_ns);
  double duration_s = kPeriod_s;

  while (result.fault == Fault::none) {
    result.fault = tick(request, now_ns, duration_s, stop.latched());
    ++result.ticks;
    if (touched_ && first_contact_ns < 0 && result.fault == Fault::none) first_contact_ns = now_ns;
    if (result.fault != Fault::none) break;

    deadline_ns += kPeriod_ns;
    if (listeners_.snapshot != nullptr && result.ticks % kSnapshotEvery_ticks == 1)
      show(result.ticks, 1e-9 * static_cast<double>(deadline_ns - start_ns));
    clock_.sleep_until_ns(deadline_ns);
    now_ns = clock_.now_ns();
    late_ns_ = std::max<std::int64_t>(now_ns - deadline_ns, 0);
    lateness_.add(late_ns_);
    const std::int64_t skipped = late_ns_ / kPeriod_ns;
    result.overruns += skipped;
    deadline_ns += skipped * kPeriod_ns;
    // Also where the interval is over by now: for so long the finger felt what no tick had asked for.
    if (late_ns_ > kMaxAge_ns) {
      result.fault = Fault::command_gap;
      for (Channeled& one : devices_) one.governor.trip(Fault::command_gap);
      break;
    }
    duration_s = kPeriod_s * static_cast<double>(1 + skipped);

    // Deadlines, not wake-ups, end an interval: its length does not depend on the machine.
    const std::int64_t explored_since_ns = free ? start_ns : first_contact_ns;
    if (explored_since_ns >= 0 && deadline_ns - explored_since_ns >= explore_ns) break;
    if (first_contact_ns >= 0 && !free && ended_early(request, result.ticks)) break;
    if (explored_since_ns < 0 && deadline_ns - start_ns >= time_out_ns) {
      result.fault = Fault::no_contact;
      break;
    }
  }
  stop_all(now_ns);
  result.duration_s = 1e-9 * static_cast<double>(now_ns - start_ns);
  if (first_contact_ns >= 0) result.first_contact_s = 1e-9 * static_cast<double>(first_contact_ns - start_ns);
  if (result.fault == Fault::emergency_stop) result.stopped_by = to_string(stop.source());
  summarise(result);
  return result;
}

}  // namespace jnd
