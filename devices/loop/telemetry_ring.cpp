#include "devices/loop/telemetry_ring.h"

#include <algorithm>

namespace jnd {

TelemetryRing::TelemetryRing(std::size_t capacity) : capacity_(std::max<std::size_t>(capacity, 1)), queue_(capacity_) {}

std::size_t TelemetryRing::drain(std::vector<TickRecord>& records) {
  return queue_.consume_all([&](const TickRecord& record) { records.push_back(record); });
}

}  // namespace jnd
