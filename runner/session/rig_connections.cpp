#include "runner/session/rig_connections.h"

#include <cmath>
#include <string>
#include <utility>

#include "data/log/event_body.h"
#include "devices/hid/calibration/calibration_certificate.h"

namespace jnd {

namespace {

// What is back by then was not missing: a device's last word before it came to rest, say.
constexpr std::int64_t kGrace_ns = 300'000'000;

}  // namespace

void note_connections(const SessionParts& parts, const SessionRecorder& recorder, std::string_view when) {
  const RigConnections connections = parts.rig.connections();
  if (connections.devices.empty() && !connections.tracker) return;
  recorder.append(event_kind::kConnections, connections_body(connections, when));
}

void note_calibrations(const SessionParts& parts, const SessionRecorder& recorder,
                       const std::vector<std::filesystem::path>& folders) {
  for (const DeviceLinkReport& device : parts.rig.connections().devices) {
    if (device.calibration_id.empty()) continue;
    nlohmann::ordered_json certificate = nullptr;
    for (const std::filesystem::path& folder : folders) {
      const auto found = find_certificate(folder, device.calibration_id);
      if (!found) continue;
      certificate = load_certificate(*found);
      break;
    }
    recorder.append(event_kind::kCalibration, {{"serial", device.serial},
                                               {"calibration_id", device.calibration_id},
                                               {"certificate", std::move(certificate)}});
  }
}

bool counts_as_attempt(const SessionParts& parts, Fault fault) {
  const bool gone = fault == Fault::device_lost || fault == Fault::stale_reading || fault == Fault::stale_pose;
  return !gone || parts.rig.missing().empty();
}

std::string missing_of(Rig& rig, bool sealed) {
  return sealed ? rig.missing_sealed() : rig.missing();
}

void await_rig(const SessionParts& parts, const SessionRecorder& recorder, int after_trial) {
  const std::int64_t began_ns = parts.clock.now_ns();
  const auto look_again = [&] {
    parts.clock.sleep_until_ns(parts.clock.now_ns() + kLook_ns);
    parts.rig.neutral();  // a device forgets a fault that is over when it is told to rest, and not before
  };
  while (!parts.rig.missing().empty() && parts.clock.now_ns() - began_ns < kGrace_ns) look_again();
  std::string missing = missing_of(parts.rig, parts.sealed);
  if (missing.empty()) return;
  parts.rig.neutral();
  note_connections(parts, recorder, "missing");
  const auto back = [&] {
    parts.rig.neutral();
    return parts.rig.missing().empty();
  };
  while (!missing.empty()) {
    handle_interrupts(parts, recorder, after_trial);
    if (parts.person)
      settle(parts, recorder, after_trial, [&] { return parts.view.missing(missing, back); });
    else if (parts.clock.now_ns() - began_ns > static_cast<std::int64_t>(1e9 * kLongestWait_s))
      throw SessionEnds{false, "missing", missing};
    look_again();
    missing = missing_of(parts.rig, parts.sealed);
  }
  note_connections(parts, recorder, "back");
}

namespace {

using Json = nlohmann::ordered_json;

Json number_or_null(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json body_of(const DeviceLinkReport& device) {
  return {{"serial", device.serial},
          {"finger", device.finger},
          {"firmware", device.firmware},
          {"protocol_version", device.protocol_version},
          {"calibration_id", device.calibration_id},
          {"calibration_date", device.calibration_date},
          {"is_model", device.is_model},
          {"connected", device.connected},
          {"trouble", device.trouble},
          {"sent", device.sent},
          {"overtaken", device.overtaken},
          {"received", device.received},
          {"missing", device.missing},
          {"damaged", device.damaged},
          {"rejected", device.rejected},
          {"reconnections", device.reconnections},
          {"clock_offset_s", number_or_null(device.clock_offset_s)},
          {"clock_drift_ppm", number_or_null(device.clock_drift_ppm)},
          {"clock_uncertainty_s", number_or_null(device.clock_uncertainty_s)},
          {"latency_p50_us", number_or_null(device.latency_p50_us)},
          {"latency_p99_us", number_or_null(device.latency_p99_us)},
          {"latency_max_us", number_or_null(device.latency_max_us)},
          {"slowest_presenting_ms", device.slowest_presenting_ms},
          {"slowest_waiting_ms", device.slowest_waiting_ms}};
}

Json body_of(const TrackerReport& tracker) {
  return {{"kind", tracker.kind},
          {"source", tracker.source},
          {"firmware", tracker.firmware},
          {"is_model", tracker.is_model},
          {"connected", tracker.connected},
          {"trouble", tracker.trouble},
          {"poses", tracker.poses},
          {"gaps", tracker.gaps},
          {"refused", tracker.refused},
          {"rate_hz", number_or_null(tracker.rate_hz)},
          {"latency_p50_ms", number_or_null(tracker.latency_p50_ms)},
          {"latency_p99_ms", number_or_null(tracker.latency_p99_ms)},
          {"latency_max_ms", number_or_null(tracker.latency_max_ms)},
          {"longest_wait_ms", number_or_null(tracker.longest_wait_ms)}};
}

}  // namespace

Json connections_body(const RigConnections& connections, std::string_view when) {
  Json devices = Json::array();
  for (const DeviceLinkReport& device : connections.devices) devices.push_back(body_of(device));
  Json tracker = connections.tracker ? body_of(*connections.tracker) : Json(nullptr);
  return {{"when", when}, {"devices", std::move(devices)}, {"tracker", std::move(tracker)}};
}

}  // namespace jnd
