// The seam between an experiment and its devices: a rig presents a stimulus and says what was really delivered.
#pragma once

#include <atomic>
#include <string>

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
};

struct RigInfo {
  std::string name;     // "rrs3 x 2"
  std::string mode;     // rendering mode: "wrench"
  std::string tracker;  // "hand"
  bool simulated = true;
};

// Thread rule: one thread at a time calls present and neutral; stop_requested may be set from any thread.
class Rig {
 public:
  virtual ~Rig() = default;
  virtual const RigInfo& info() const noexcept = 0;

  // Engages the devices (soft start), renders until explore_s after first contact, and ends with force zero and the
  // platform neutral. A fault ends it early and is in the result; it does not throw.
  virtual Presentation present(const PresentRequest& request) = 0;

  // Force to zero and platform to rest, at once. Safe to call at any time.
  virtual void neutral() noexcept = 0;

  // The latch that stops any presentation within two ticks.
  std::atomic<bool> stop_requested{false};
};

}  // namespace jnd
