// The seam between an experiment and its devices: a rig presents a stimulus and says what was really delivered.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "devices/emergency_stop.h"
#include "devices/realtime.h"
#include "protocols/protocol.h"
#include "protocols/trace.h"
#include "protocols/vocabulary.h"

namespace jnd {

// Which interval of which trial is presented: simulated hands key their randomness by it, telemetry its records.
struct IntervalId {
  int trial = 0;  // Trial::index
  int attempt = 1;
  int interval = 0;  // 0, 1 or 2
  bool operator==(const IntervalId&) const = default;
};

// One number for an interval of a trial, so that every draw made in it is keyed by it: a session that is resumed, or a
// trial that is repeated, draws what it would have drawn anyway:
// the part of a RandomStream. sub: such as a finger, 0..255. Unique for attempts and intervals below 256.
constexpr std::uint64_t interval_part(const IntervalId& id, int sub) noexcept {
  return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(id.trial)) << 24U) |
         (static_cast<std::uint64_t>(id.attempt & 0xFF) << 16U) |
         (static_cast<std::uint64_t>(id.interval & 0xFF) << 8U) | static_cast<std::uint64_t>(sub & 0xFF);
}

struct PresentRequest {
  Stimulus stimulus;
  std::optional<double> beside{};  // a second value that is felt at the same time, in a place of its own
  double explore_s = 0;            // from first contact
  // What ends it before explore_s: so many contacts have ended (0: none do), or `enough` says so, which is asked some 20
  // times a second by the thread that called present (empty: nothing does).
  int contacts = 0;
  std::function<bool()> enough{};
  double no_contact_time_out_s = 0;
  IntervalId id;
  const Condition* condition = nullptr;  // of the trial: what a rig that is none of ours is told of it
  // What is felt is the standard, and what is felt beside it is: Condition::standard_parameters hold there.
  bool of_standard = false, beside_of_standard = false;
  // Name of a virtual object instead of the protocol's; empty: the protocol's. It is free interaction: explore_s counts
  // from the start, and a finger that touches nothing is no fault.
  std::string object{};
  // Above 0: a tap of the device instead of a stimulus, a burst of vibration of so many g from the start. There is
  // nothing to touch, and explore_s counts from the start.
  double tap_g = 0;
};

// The control loop as it is just now; for the operator's eyes. It has nothing that follows from a force, because forces
// tell the stimulus, and whether the condition has any.
struct LoopSnapshot {
  std::int64_t ticks = 0;  // of the presentation so far
  double elapsed_s = 0;    // to the end of the last of them
  double lateness_max_us = 0;
  bool contact = false;  // a finger is in the object, whatever its devices render there
};

struct RigInfo {
  std::string name;     // "rrs3 x 2"
  std::string mode;     // rendering mode: "wrench", "pd", "pd-literal"; the controller of a joint: "PI"
  std::string tracker;  // "hid", "process", "replay", "hand", "encoder"; "hand (for hid)" where one stands in
  std::string sha256;   // of the rig's description
  bool simulated = true;
};

// One device's connection, since the rig was made.
struct DeviceLinkReport {
  std::string serial, finger;
  std::string firmware;          // "1.0.0"
  int protocol_version = 0;      // of the reports, as negotiated
  std::string calibration_id;    // as the device says; empty: never calibrated
  std::string calibration_date;  // "2026-03-01", or empty
  bool is_model = false;         // in software, by its own word: what is felt with it is no real data
  bool connected = false;
  std::string trouble;         // why not, or why the device stopped itself last; empty where all is well
  std::int64_t sent = 0;       // commands handed to the system
  std::int64_t overtaken = 0;  // by newer ones before they could be
  std::int64_t received = 0;   // reports of telemetry
  std::int64_t missing = 0;    // of the device's own numbering
  std::int64_t damaged = 0;    // reports that were none of the protocol's
  std::int64_t rejected = 0;   // commands that the device refused
  int reconnections = 0;
  // Device clock = offset + (1 + drift) * host clock, over the last minutes; uncertainty: half the shortest round trip.
  double clock_offset_s = 0, clock_drift_ppm = 0, clock_uncertainty_s = 0;
  double latency_p50_us = 0, latency_p99_us = 0, latency_max_us = 0;  // from a command's writing to its echo's arrival
  double slowest_presenting_ms = 0, slowest_waiting_ms = 0;           // answers of an external rig to `alive`
};

// What a tracker's stream of poses was like, since the rig was made.
struct TrackerReport {
  std::string kind;       // "hid", "process", "replay", "hand"
  std::string source;     // a serial number, a command line, a file
  std::string firmware;   // of one over HID, "1.0.0"
  bool is_model = false;  // as of a device
  bool connected = false;
  std::string trouble;
  std::int64_t poses = 0;
  std::int64_t gaps = 0;     // poses missing by the source's own numbering, or where it has none, waits above 20 ms
  std::int64_t refused = 0;  // lines or reports that were no pose
  double rate_hz = 0;        // poses a second of one finger, while they came
  double latency_p50_ms = 0, latency_p99_ms = 0, latency_max_ms = 0;  // from when a pose was true to its arrival
  double longest_wait_ms = 0;                                         // between two poses of a finger
};

struct RigConnections {
  std::vector<DeviceLinkReport> devices;
  std::optional<TrackerReport> tracker;

  // Whether anything of it is a model in software.
  bool on_a_model() const noexcept {
    for (const DeviceLinkReport& device : devices)
      if (device.is_model) return true;
    return tracker && tracker->is_model;
  }
};

class TelemetryRing;

// Buttons of a rig's own, by which participants answer. Thread rule: that of the rig's presentations.
class RigButtons {
 public:
  struct Pressed {
    std::size_t place = 0;     // in the answers
    std::int64_t time_ns = 0;  // of the machine's monotonic clock
  };
  virtual ~RigButtons() = default;
  // The question is asked: a button answers it from now on, until it is withdrawn. answers: the words of the protocol.
  virtual void ask(const std::vector<std::string>& answers) = 0;
  virtual std::optional<Pressed> pressed() = 0;  // once
  virtual void withdraw() = 0;
};

// Thread rule: one thread at a time calls present and neutral; stop may be latched from any thread.
class Rig {
 public:
  virtual ~Rig() = default;
  virtual const RigInfo& info() const noexcept = 0;

  // Engages the devices (soft start), renders until explore_s after first contact, and ends with force zero and the
  // platform neutral. A fault ends it early and is in the result; it does not throw.
  virtual Presentation present(const PresentRequest& request) = 0;

  // Gets ready for that presentation, and nobody feels it. How long that takes may depend on the stimulus and the one
  // before, so it belongs where nothing is timed. Returns at once, with the time of the session's clock from when the cue
  // and present() may come; what is ready stays so. neutral() and another presentation end it. A rig that is always ready
  // has nothing to do.
  virtual std::int64_t prepare(const PresentRequest& /*request*/) { return 0; }

  // Force to zero and platform to rest, at once. Safe to call at any time.
  virtual void neutral() noexcept = 0;

  // Where every tick of a presentation is recorded, to be drained after it; null where none is.
  virtual TelemetryRing* telemetry() noexcept { return nullptr; }
  // The same ticks once more, to be drained while the presentation goes on: forces for a technician's eyes. Null where
  // nobody may see them, and where the rig cannot show any.
  virtual TelemetryRing* live() noexcept { return nullptr; }
  // What a rig of the laboratory's own measured in the last presentation, taken away.
  virtual Trace take_trace() { return {}; }
  // Null where it has none.
  virtual RigButtons* buttons() noexcept { return nullptr; }
  // While a presentation goes on, `look` is called some 20 times a second by the thread that called present, never by
  // the loop. Empty: no more. A rig whose loop runs inside present on a simulated clock never calls it.
  virtual void watch(const std::function<void(const LoopSnapshot&)>& /*look*/) {}
  // What is missing for a presentation, in the operator's words, such as a device that was unplugged, or has a fault;
  // empty: nothing. Devices forget a fault that is over when they are told to rest: call neutral() between looks.
  virtual std::string missing() { return {}; }
  // The same without the words of programs behind the rig, which may name the stimulus.
  virtual std::string missing_sealed() { return missing(); }
  // The connections to devices and tracker, for the log; nothing for models inside the program.
  virtual RigConnections connections() const { return {}; }
  // What real-time scheduling the loop got.
  virtual RealtimeReport realtime() const { return {}; }

  // Stops any presentation within two ticks, and prevents the next one until it is cleared.
  EmergencyStop stop;
};

// A connection that a rig's device depends on.
// Thread rule: any thread.
class RigLink {
 public:
  virtual ~RigLink() = default;
  virtual DeviceLinkReport report() const = 0;
  // What is missing, in the operator's words; empty: nothing.
  virtual std::string missing() const = 0;
  // From now on the stop button on the device latches `stop`, at once; null: no more. `stop` must live until then.
  virtual void stop_with(EmergencyStop* stop) noexcept = 0;
};

}  // namespace jnd
