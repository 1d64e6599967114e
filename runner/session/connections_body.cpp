#include "runner/session/connections_body.h"

#include <cmath>
#include <utility>

namespace jnd {

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
