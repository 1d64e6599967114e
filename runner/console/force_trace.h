// What a technician sees of the devices: force and depth of the last seconds. It tells the stimulus, so it is made only
// where a session is marked as unblinded (`jnd run --technician`).
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "devices/loop/telemetry_ring.h"

namespace jnd {

// Thread rule: the session's thread only.
class ForceTrace {
 public:
  static constexpr double kKept_s = 5;

  struct Sample {
    std::int64_t time_ns = 0;            // of the loop's clock
    double depth = 0;                    // m, or rad where in_metres() is false
    double asked_n = 0, measured_n = 0;  // before the governor's limits; by the device
    bool begins = false;                 // the first one after the devices were at rest
  };
  struct Device {
    std::string name;                // of its finger, and of its channel where a finger has two
    std::deque<Sample> samples;      // oldest first, one every 10 ms
    double deepest = 0, peak_n = 0;  // of the presentation that goes on, or of the last one
    bool begins = true;              // with the next tick
  };

  // names: of the devices, in the order of TickRecord::channel. in_metres: depth is in m, otherwise in rad.
  ForceTrace(const std::vector<std::string>& names, bool in_metres);

  // Takes away what waits there.
  void take(TelemetryRing& ring);
  // The next tick is the first one of another presentation.
  void presentation_over() noexcept;

  const std::vector<Device>& devices() const noexcept { return devices_; }
  bool in_metres() const noexcept { return in_metres_; }
  // Of the newest sample of any device; samples older by kKept_s are forgotten.
  std::int64_t now_ns() const noexcept { return now_ns_; }

 private:
  std::vector<Device> devices_;
  bool in_metres_;
  std::int64_t now_ns_ = 0;
  std::vector<TickRecord> taken_;
};

// "peak 2.31 N at 4.6 mm deep": the presentation that goes on, or the last one.
std::string peak_text(const ForceTrace::Device& device, bool in_metres);
}  // namespace jnd
