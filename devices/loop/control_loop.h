// The loop that renders one interval: all devices of a rig, 1 kHz, on absolute deadlines of the clock.
//
// One tick, always in this order: read -> contact -> render -> governor -> write -> telemetry. Within a tick nothing
// allocates, locks, throws or waits. A late tick skips whole periods, which are counted, never caught up in a burst:
// deadlines are start + n periods for ever.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "devices/clock.h"
#include "devices/contact/god_object.h"
#include "devices/emergency_stop.h"
#include "devices/fingertip_device.h"
#include "devices/loop/governor.h"
#include "devices/loop/interval_summary.h"
#include "devices/loop/newest_slot.h"
#include "devices/loop/telemetry_ring.h"
#include "devices/rig.h"
#include "devices/tracker.h"
#include "protocols/rigs/device_description.h"
#include "protocols/tick_record.h"

namespace jnd {

// The control loop's latest state, for readers on other threads.
using LatestSnapshot = NewestSlot<LoopSnapshot>;

// Notices a force sensor that has stopped telling: its reading stays the same to the last bit while the force that is
// given to the device goes up or down. Nothing allocates.
class SensorWatch {
 public:
  // A change of force that a working sensor must notice: ten times the resolution of a cheap 8-bit one over 5 N.
  static constexpr double kChange_n = 0.5;
  // How long it may take: the valve and muscle of a McKibben finger answer within 100 ms.
  static constexpr std::int64_t kPatience_ns = 150'000'000;

  void begin() noexcept { *this = SensorWatch{}; }

  // given_n: what the governor let through at this tick. True where the reading is no longer to be believed.
  bool stuck(double measured_n, double given_n, std::int64_t now_ns) noexcept {
    if (!seen_ || measured_n != measured_n_) {
      seen_ = true;
      measured_n_ = measured_n;
      lowest_n_ = highest_n_ = given_n;
      changed_ns_ = -1;
      return false;
    }
    lowest_n_ = std::min(lowest_n_, given_n);
    highest_n_ = std::max(highest_n_, given_n);
    if (highest_n_ - lowest_n_ <= kChange_n) return false;
    if (changed_ns_ < 0) changed_ns_ = now_ns;
    return now_ns - changed_ns_ > kPatience_ns;
  }

 private:
  bool seen_ = false;
  double measured_n_ = 0, lowest_n_ = 0, highest_n_ = 0;
  std::int64_t changed_ns_ = -1;  // since when the reading ought to have moved
};

// The last ticks of a loop, overwritten in a circle: what led to a stop. Nothing in next() allocates.
class TickRing {
 public:
  static constexpr std::size_t kSize = 512;  // more than kTicksBeforeStop of each of four devices
  void clear() noexcept { written_ = 0; }
  TickRecord& next() noexcept { return records_[written_++ % kSize]; }
  // Oldest first, at most `most` of them.
  std::vector<TickRecord> in_order(std::size_t most = kSize) const {
    std::vector<TickRecord> records;
    for (std::size_t i = written_ - std::min({written_, kSize, most}); i < written_; ++i)
      records.push_back(records_[i % kSize]);
    return records;
  }

 private:
  std::array<TickRecord, kSize> records_{};
  std::size_t written_ = 0;
};

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

// How punctual a loop of 1 ms has to be: one scale for jnd doctor, for readiness, and for what a session shows.
struct LoopLimits {
  double p99_us;         // 99th percentile of the lateness
  double largest_us;     // lateness
  double skipped_share;  // of the ticks that were due, 0..1
};

// Beyond one of these a warning: a tenth of a period; a period, which is a skipped tick.
inline constexpr LoopLimits kTightLoop{.p99_us = 100, .largest_us = 1000, .skipped_share = 0};

// A tick that comes this late voids its trial (command_gap): with the period before it no command for 20 ms.
inline constexpr double kGapLateness_us = 1e-3 * static_cast<double>(kMaxAge_ns - kPeriod_ns);

// At one of these the loop is unfit: one tick in a hundred is late by a period or skipped, or a tick is half as late as
// voids a trial: who measures for seconds sees the usual largest, and a session lasts hundreds of times as long.
inline constexpr LoopLimits kUnfitLoop{.p99_us = 1000, .largest_us = kGapLateness_us / 2, .skipped_share = 0.01};

inline double skipped_share(std::int64_t ticks, std::int64_t skipped) noexcept {
  return skipped > 0 ? static_cast<double>(skipped) / static_cast<double>(ticks + skipped) : 0;
}

}  // namespace jnd
