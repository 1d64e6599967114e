// The loop that renders one interval: all devices of a rig, 1 kHz, on absolute deadlines of the clock.
//
// One tick, always in this order: read -> contact -> render -> governor -> write -> telemetry. Within a tick nothing
// allocates, locks, throws or waits. A late tick skips whole periods, which are counted, never caught up in a burst:
// deadlines are start + n periods for ever.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "devices/clock.h"
#include "devices/contact/god_object.h"
#include "devices/contact/joint_contact.h"
#include "devices/emergency_stop.h"
#include "devices/fingertip_device.h"
#include "devices/loop/governor.h"
#include "devices/loop/interval_summary.h"
#include "devices/loop/lateness.h"
#include "devices/loop/latest_snapshot.h"
#include "devices/loop/sensor_watch.h"
#include "devices/loop/telemetry_ring.h"
#include "devices/loop/tick_ring.h"
#include "devices/rig.h"
#include "devices/tracker.h"
#include "protocols/rigs/device_description.h"

namespace jnd {

inline constexpr std::int64_t kPeriod_ns = 1'000'000;

// One device of the loop and what it acts on. The device must outlive the loop.
struct LoopDevice {
  FingertipDevice* device = nullptr;
  DeviceSpec spec;
  int finger = 0;  // from 0, without gaps
  Channel channel = Channel::cutaneous;
  double force_gain = 1;  // force asked of the device per contact force: of a joint, the ratio of the two lever arms
};

// What the fingers meet: an object in space, or, for joints, an angle.
struct LoopScene {
  VirtualObject object{};
  std::map<std::string, VirtualObject> named{};  // for free interaction, by PresentRequest::object
  std::optional<JointObject> joint{};
};

// Where the loop tells what it does; null: nowhere.
struct LoopListeners {
  TelemetryRing* telemetry = nullptr;  // every tick, to be kept
  TelemetryRing* live = nullptr;       // every tick, to be looked at meanwhile
  LatestSnapshot* snapshot = nullptr;  // its latest state
};

// Thread rule: one thread calls run; the stop latch may be set from any. Tracker, clock and listeners must outlive the
// loop.
class ControlLoop {
 public:
  ControlLoop(const std::vector<LoopDevice>& devices, Tracker& tracker, Clock& clock, const LoopScene& scene,
              const LoopListeners& listeners = {});

  // Renders until explore_s after the first contact of any finger, or what the request has end it before, the no-contact
  // time-out, a fault or the latch; ends with zero force and the devices neutral. Free interaction and taps last
  // explore_s from their start. PresentRequest::enough is asked from within, so it must be empty where the loop runs on
  // a thread of its own. Throws std::invalid_argument where the request names an object that the scene has not.
  Presentation run(const PresentRequest& request, const EmergencyStop& stop);
  // What goes on is over with the next tick, as it would be after explore_s. Any thread.
  void end_interval() noexcept { over_.store(true, std::memory_order_relaxed); }

 private:
  struct Finger {
    GodObject object;
    JointContact joint;
    FingerPose pose;
    double penetration = 0;       // of the last tick
    double penetration_rate = 0;  // per second
    std::int64_t burst_until_ns = 0;
    int contacts_ended = 0;
  };
  struct Channeled {  // a device at work
    LoopDevice setup;
    Governor governor;
    IntervalSummary summary;
    SensorWatch watch;
    DeviceReading reading;
    GovernorInput input;
  };

  const VirtualObject& object_of(const PresentRequest& request) const;
  // Ended before explore_s, after the first contact.
  bool ended_early(const PresentRequest& request, std::int64_t ticks) const;
  Fault engage(const PresentRequest& request, std::int64_t start_ns);
  Fault tick(const PresentRequest& request, std::int64_t now_ns, double duration_s, bool stop) noexcept;
  Fault read(std::int64_t now_ns) noexcept;
  void update_contact(const PresentRequest& request, std::int64_t now_ns, double duration_s) noexcept;
  const Contact& contact_of(const Finger& finger) const noexcept;
  Fault act(int place, const PresentRequest& request, std::int64_t now_ns, double duration_s) noexcept;
  void render(Channeled& one, const PresentRequest& request, std::int64_t now_ns) const noexcept;
  void record(int place, const GovernorOutput& out, std::int64_t now_ns, double duration_s) noexcept;
  void stop_all(std::int64_t now_ns) noexcept;
  void show(std::int64_t ticks, double elapsed_s) noexcept;
  void summarise(Presentation& result) const;

  std::vector<Finger> fingers_;
  std::vector<Channeled> devices_;
  Tracker& tracker_;
  Clock& clock_;
  LoopScene scene_;
  LoopListeners listeners_;
  TickRing ring_;
  LatenessHistogram lateness_;
  std::int64_t late_ns_ = 0;  // of this tick
  bool touched_ = false;      // any finger, in this tick
  std::atomic<bool> over_{false};
};

}  // namespace jnd
