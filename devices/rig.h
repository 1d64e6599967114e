// The seam between an experiment and its devices: a rig presents a stimulus and says what was really delivered.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "devices/emergency_stop.h"
#include "devices/realtime.h"
#include "protocols/vocabulary.h"

namespace jnd {

// Which interval of which trial is presented: simulated hands key their randomness by it, telemetry its records.
struct IntervalId {
  int trial = 0;  // Trial::index
  int attempt = 1;
  int interval = 0;  // 0 or 1
};

struct PresentRequest {
  Stimulus stimulus;
  double explore_s = 0;  // from first contact
  double no_contact_time_out_s = 0;
  IntervalId id;
  // Name of a virtual object instead of the protocol's; empty: the protocol's. It is free interaction: explore_s counts
  // from the start, and a finger that touches nothing is no fault.
  std::string object{};
  // Above 0: a tap of the device instead of a stimulus, a burst of vibration of so many g from the start. There is
  // nothing to touch, and explore_s counts from the start.
  double tap_g = 0;
};

// The control loop as it is just now; for the operator's eyes.
struct LoopGlimpse {
  std::int64_t ticks = 0;  // of the presentation so far
  double elapsed_s = 0;    // to the end of the last of them
  double lateness_p99_us = 0, lateness_max_us = 0;
  double force_n = 0, force_cap_n = 0;  // given just now, and at most: of the device that is nearest to its cap
  bool saturated = false;               // a limit has reduced the asked force in this presentation
};

struct RigInfo {
  std::string name;     // "rrs3 x 2"
  std::string mode;     // rendering mode: "wrench", "pd", "pd-literal"; the controller of a joint: "PI"
  std::string tracker;  // "hand", "encoder"
  std::string sha256;   // of the rig's description
  bool simulated = true;
};

class TelemetryRing;

// Thread rule: one thread at a time calls present and neutral; stop may be latched from any thread.
class Rig {
 public:
  virtual ~Rig() = default;
  virtual const RigInfo& info() const noexcept = 0;

  // Engages the devices (soft start), renders until explore_s after first contact, and ends with force zero and the
  // platform neutral. A fault ends it early and is in the result; it does not throw.
  virtual Presentation present(const PresentRequest& request) = 0;

  // Force to zero and platform to rest, at once. Safe to call at any time.
  virtual void neutral() noexcept = 0;

  // Where every tick of a presentation is recorded, to be drained after it; null where none is.
  virtual TelemetryRing* telemetry() noexcept { return nullptr; }
  // While a presentation goes on, `look` is called some 20 times a second by the thread that called present, never by
  // the loop. Empty: no more. A rig whose loop runs inside present on a simulated clock never calls it.
  virtual void watch(const std::function<void(const LoopGlimpse&)>& /*look*/) {}
  // What real-time scheduling the loop got.
  virtual RealtimeReport realtime() const { return {}; }

  // Stops any presentation within two ticks, and prevents the next one until it is cleared.
  EmergencyStop stop;
};

}  // namespace jnd
