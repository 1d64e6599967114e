// A rig's own trace of one interval as a compressed blob beside the event it belongs to, where our devices' ticks would
// stand. The format is described in data/README.md, and is versioned by itself.
#pragma once

#include <cstdint>
#include <string_view>

#include "data/log/session_log.h"
#include "protocols/trace.h"

namespace jnd {

inline constexpr std::uint32_t kTraceVersion = 1;
inline constexpr std::int64_t kMaxTraceSamples = 4'000'000;
inline constexpr std::size_t kMaxTraceChannels = 64;

// interval: 0, 1 or 2. TelemetryBlob::ticks counts samples; of more than kMaxTraceSamples the first ones are kept and the
// others counted as dropped. Throws StorageError where a sample is of a channel that there is not, or a name is too long.
TelemetryBlob encode_trace(int interval, const Trace& trace);
// Throws StorageError, saying what is wrong, where the bytes are not a whole blob of a version up to kTraceVersion.
Trace decode_trace(std::string_view bytes);
// Whether they are a trace, and not ticks of our devices. Throws StorageError where they cannot be decompressed.
bool is_trace(std::string_view bytes);

}  // namespace jnd
