// Telemetry: every tick of one interval, as a compressed blob beside the event it belongs to.
//
// The format is described in data/README.md, with a few lines of Python that read it. It is versioned by itself, apart
// from the schema of the study.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "data/log/session_log.h"
#include "protocols/tick_record.h"
#include "protocols/vocabulary.h"

namespace jnd {

inline constexpr std::uint32_t kTelemetryVersion = 1;
// Records that one blob holds at most: more than half an hour of two devices at 1 kHz. It bounds what reading a damaged
// blob can cost (416 MB).
inline constexpr std::int64_t kMaxTelemetryTicks = 4'000'000;
inline constexpr std::size_t kMaxTelemetryChannels = 16;

// What TickRecord::channel counts: an entry for each device, in the order of Presentation::fingers.
struct TelemetryChannel {
  int finger = 0;  // place in RigRequest::fingers
  Channel channel = Channel::cutaneous;
  bool operator==(const TelemetryChannel&) const = default;
};

struct Telemetry {
  Unit unit = Unit::n_per_m;  // of the study: penetrations are in m or in rad
  std::vector<TelemetryChannel> channels;
  std::int64_t dropped = 0;  // records that were lost before they could be kept
  std::vector<TickRecord> ticks;
};

// The devices of a presentation, in order.
std::vector<TelemetryChannel> telemetry_channels(const Presentation& presentation);

// interval: 0 or 1. Every value comes back to the bit. Of more than kMaxTelemetryTicks records the first ones are kept
// and the others counted as dropped. Throws StorageError where a record is of a channel that there is not, or there are
// more than kMaxTelemetryChannels.
TelemetryBlob encode_telemetry(int interval, const Telemetry& telemetry);

// Throws StorageError, saying what is wrong, where the bytes are not a whole blob of a version up to kTelemetryVersion.
Telemetry decode_telemetry(std::string_view bytes);

// What the event that the blobs belong to says of them, under "telemetry": [{interval, sha256, ticks, dropped}].
nlohmann::ordered_json telemetry_body(const std::vector<TelemetryBlob>& blobs);
// The blobs that an event's body names, without their bytes; empty where it names none. Throws StorageError.
std::vector<TelemetryBlob> named_telemetry(const nlohmann::ordered_json& body);

}  // namespace jnd
