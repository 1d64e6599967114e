// The loop that renders one interval: all fingers, 1 kHz, on absolute deadlines of the clock.
//
// One tick, always in this order: read -> contact -> render -> governor -> write -> telemetry. Within a tick nothing
// allocates, locks, throws or waits. A late tick skips whole periods, which are counted, never caught up in a burst.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <vector>

#include "devices/clock.h"
#include "devices/contact.h"
#include "devices/fingertip_device.h"
#include "devices/governor.h"
#include "devices/interval_summary.h"
#include "devices/lateness.h"
#include "devices/rig.h"
#include "devices/tracker.h"

namespace jnd {

inline constexpr std::int64_t kPeriod_ns = 1'000'000;

// What one finger asked and got at one tick.
struct TickRecord {
  std::int64_t time_ns = 0;  // of the loop's clock
  int finger = 0;
  double penetration_m = 0;
  double asked_n = 0, given_n = 0, measured_n = 0;
  double vibration_g = 0;  // given
  unsigned limits = 0;     // bits of namespace limit
};

// The last ticks before a stop: a ring that is never too small to say what led to it.
class TickRing {
 public:
  static constexpr std::size_t kSize = 512;  // a quarter of a second for two fingers
  void clear() noexcept { written_ = 0; }
  TickRecord& next() noexcept { return records_[written_++ % kSize]; }
  std::vector<TickRecord> in_order() const;  // oldest first

 private:
  std::array<TickRecord, kSize> records_{};
  std::size_t written_ = 0;
};

// Thread rule: one thread calls run; the stop latch may be set from any. Devices, tracker and clock must outlive the
// loop.
class ControlLoop {
 public:
  ControlLoop(std::vector<FingertipDevice*> devices, Tracker& tracker, Clock& clock, const DeviceSpec& spec,
              const Sphere& sphere);

  // Renders until explore_s after the first contact of any finger, the no-contact time-out, a fault or the latch; ends
  // with zero force and the devices neutral.
  Presentation run(const PresentRequest& request, const std::atomic<bool>& stop);

  const TickRing& last_ticks() const noexcept { return ring_; }

 private:
  struct Finger {
    FingertipDevice* device = nullptr;
    SphereContact contact;
    Governor governor;
    IntervalSummary summary;
    FingerPose pose;
    DeviceReading reading;
    GovernorInput input;
    std::int64_t burst_until_ns = 0;
    bool vibration_clamped = false;
  };

  Fault engage(const PresentRequest& request, std::int64_t start_ns);
  Fault tick(const PresentRequest& request, std::int64_t now_ns, double duration_s, bool stop) noexcept;
  Fault tick_finger(int index, const PresentRequest& request, std::int64_t now_ns, double duration_s) noexcept;
  void stop_all(std::int64_t now_ns) noexcept;

  std::vector<Finger> fingers_;
  Tracker& tracker_;
  Clock& clock_;
  DeviceSpec spec_;
  Sphere sphere_;
  TickRing ring_;
  LatenessHistogram lateness_;
  bool touched_ = false;  // any finger, in this tick
};

}  // namespace jnd
