#include "data/log/session_log.h"

#include "data/log/event_body.h"
#include "data/log/storage_error.h"
#include "data/log/telemetry.h"

namespace jnd {

void SessionLog::append(std::string_view kind, const nlohmann::ordered_json& body, Stamp stamp,
                        const std::vector<TelemetryBlob>& /*telemetry*/) {
  append(kind, body, stamp);
}

void MemoryLog::append(std::string_view kind, const nlohmann::ordered_json& body, Stamp stamp) {
  Event event;
  event.seq = static_cast<std::int64_t>(events_.size()) + 1;
  event.kind = kind;
  event.stamp = stamp;
  event.body = body_text(body);
  events_.push_back(std::move(event));
}

void MemoryLog::append(std::string_view kind, const nlohmann::ordered_json& body, Stamp stamp,
                       const std::vector<TelemetryBlob>& telemetry) {
  require_named(body, telemetry);
  append(kind, body, stamp);
  if (!telemetry.empty()) telemetry_[events_.back().seq] = telemetry;
}

std::vector<TelemetryBlob> MemoryLog::telemetry(std::int64_t seq) const {
  const auto found = telemetry_.find(seq);
  return found == telemetry_.end() ? std::vector<TelemetryBlob>{} : found->second;
}

void require_named(const nlohmann::ordered_json& body, const std::vector<TelemetryBlob>& telemetry) {
  if (telemetry.empty()) return;
  if (!body.contains("telemetry") || body.at("telemetry") != telemetry_body(telemetry))
    throw StorageError("an event must name the telemetry that is stored with it (\"telemetry\" in its body)");
}

}  // namespace jnd
